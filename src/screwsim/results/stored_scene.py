"""The scene stored in a results file, as a file of its own that repeats the simulation."""

import json

from screwsim.results.read import Results

_NAMES = "screwsim", "python", "numpy", "scipy", "llvmlite", "coolprop"


def scene_text(results: Results) -> str:
    """Return the scene's YAML text, below comment lines that give its source file, versions and the tables it needs."""
    told = results.attributes
    versions = ", ".join(f"{name} {told[f'{name}_version']}" for name in _NAMES if f"{name}_version" in told)
    lines = [f"# The scene of {results.path.name}, scene_sha256 {told['scene_sha256'][:16]}", f"# {versions}"]
    tables = {
        name.removeprefix("file "): digest
        for name, digest in json.loads(told["screwsim_identity"]).items()
        if name.startswith("file ")
    }
    if tables:
        beside = ", ".join(f"{name} ({digest})" for name, digest in tables.items())
        lines.append(f"# It needs these files next to it, unchanged (first digits of their SHA-256): {beside}")
    return "\n".join(lines) + "\n" + results.scene_yaml
