"""Working arrays on loan: a problem has its own while it is solved, and passes them on to the next of its structure.

Creating them costs a twentieth of a solution, mostly for first writing to their pages. Arrays on loan are exclusive;
those that are not given back, as after an error, are garbage-collected.
"""

from screwsim.model.composition import Composition
from screwsim.model.run import Machinery

STRUCTURES = 8  # for which free arrays are kept
MOST_FREE = 32  # free arrays for each structure: as many points may be solved side by side

_free: dict[str, list[Machinery]] = {}  # by the text of the module; every operation on it is atomic in the interpreter


def lease(composition: Composition) -> Machinery:
    """Return working arrays for a composition, with nothing left from earlier use."""
    try:
        machinery = _free[composition.text].pop()
    except (KeyError, IndexError):
        return Machinery(composition)
    machinery.begin(composition)
    return machinery


def give_back(machinery: Machinery) -> None:
    """Keep working arrays for the next composition of the same structure."""
    shelf = _free.setdefault(machinery.composition.text, [])
    if len(shelf) < MOST_FREE:
        shelf.append(machinery)
    for oldest in list(_free)[:-STRUCTURES]:
        _free.pop(oldest, None)
