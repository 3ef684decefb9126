"""Working arrays on loan: a problem has its own while it is solved, and leaves them to the next of its structure.

Making them anew costs a twentieth of a solution, most of it for pages that are written for the first time. What is
lent is nobody else's; what is not given back, as after an error, is left to the collector.
"""

from screwsim.model.composition import Composition
from screwsim.model.run import Machinery

STRUCTURES = 8  # of which free arrays are kept
KEPT = 32  # free ones of a structure: so many points may be solved side by side

_free: dict[str, list[Machinery]] = {}  # by the text of the module; each step on it is one of the interpreter's own


def lease(composition: Composition) -> Machinery:
    """Return working arrays for a composition, of whatever ran on them before nothing is left."""
    try:
        machinery = _free[composition.text].pop()
    except (KeyError, IndexError):
        return Machinery(composition)
    machinery.begin(composition)
    return machinery


def give_back(machinery: Machinery) -> None:
    """Keep working arrays for the next composition of the same structure."""
    shelf = _free.setdefault(machinery.composition.text, [])
    if len(shelf) < KEPT:
        shelf.append(machinery)
    for oldest in list(_free)[:-STRUCTURES]:
        _free.pop(oldest, None)
