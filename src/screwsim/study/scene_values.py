"""Values of the scene stored in a results file, by their paths, to find what differs between two scenes."""

from collections.abc import Iterator

from screwsim.scene.yaml_tree import Faults, Node, Position, compose


def scene_values(text: str, file: str, left_out: tuple[str, ...] = ()) -> dict[str, str]:
    """Return {dotted path: text} of a scene's canonical text from a file, without the sections `left_out`."""
    root = compose(text, Position(0, file), Faults())
    return {} if root is None else dict(_leaves(root, "", left_out))


def _leaves(node: Node, path: str, left_out: tuple[str, ...]) -> Iterator[tuple[str, str]]:
    if isinstance(node.value, list):
        yield path, f"[{', '.join(str(each.value) for each in node.value)}]"
        return
    if not isinstance(node.value, dict):
        yield path, str(node.value)
        return
    if not node.value and path:
        yield path, "simulated" if path.startswith("effects.") else "{}"
    for name, child in node.value.items():
        if path or name not in left_out:
            yield from _leaves(child, f"{path}.{name}" if path else name, left_out)
