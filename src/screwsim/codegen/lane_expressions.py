"""Expressions for points computed side by side: conditions and choices under a mask."""

import ast
from collections.abc import Sequence

from screwsim.codegen.kinds import FLOAT, OF_LANES, TRUTH, TRUTHS, Value
from screwsim.codegen.lane_operations import MASK, NONE_OF_THEM, LaneOperations


class LaneExpressions(LaneOperations):
    """Part of an emitter that writes expressions for all lanes.

    It knows the variables, and sets the mask of active lanes.
    """

    def set_mask(self, mask: str) -> None:
        """Set the mask of the lanes that are active from here on."""
        self.add(f"store {MASK} {mask}, ptr %m")

    def _both(self, every: bool, nodes: Sequence[ast.expr]) -> Value:
        """Return whether all conditions hold, or any; lanes that are already decided are inactive in later ones."""
        found, before = self.truth(nodes[0]), ""
        for node in nodes[1:]:
            if found.known is not None:
                if bool(found.known) is not every:
                    break
                found = self.truth(node)
                continue
            mask = before or self.mask()
            before = mask
            so_far = self.as_kind(found, TRUTHS).parts[0]
            self.set_mask(self.both(mask, so_far) if every else self.without(mask, so_far))
            value = self.truth(node)
            if found.kind == value.kind == TRUTH:
                ways = (value.parts[0], "false") if every else ("true", value.parts[0])
                found = Value(TRUTH, (self.new(f"select i1 {found.parts[0]}, i1 {ways[0]}, i1 {ways[1]}"),))
                continue
            other = self.as_kind(value, TRUTHS).parts[0]
            whole = f"{MASK} {other}, {MASK} {NONE_OF_THEM}" if every else f"{MASK} splat (i1 true), {MASK} {other}"
            found = Value(TRUTHS, (self.new(f"select {MASK} {so_far}, {whole}"),))
        if before:
            self.set_mask(before)
        return found

    def _compared(self, left: ast.expr, ops: Sequence[ast.cmpop], others: Sequence[ast.expr], node: ast.expr) -> Value:
        """Return whether all comparisons hold; later operands are not computed where no lane needs them."""
        before, after = self.expression(left), self.expression(others[0])
        whole = self.compare(ops[0], before, after, node)
        if len(ops) == 1:
            return whole
        mask, slot, end = self.mask(), self.slot(MASK), self.labels("compared")[0]
        for op, other in zip(ops[1:], others[1:], strict=True):
            so_far = self.both(mask, self.as_kind(whole, TRUTHS).parts[0])
            self.add(f"store {MASK} {so_far}, ptr {slot}")
            self.set_mask(so_far)
            more = self.labels("more")[0]
            self.branch(self.any_of(so_far), more, end)
            self.start(more)
            before, after = after, self.expression(other)
            found = self.as_kind(self.compare(op, before, after, node), TRUTHS).parts[0]
            whole = Value(TRUTHS, (self.both(so_far, found),))
        self.add(f"store {MASK} {whole.parts[0]}, ptr {slot}")
        self.jump(end)
        self.start(end)
        self.set_mask(mask)
        return Value(TRUTHS, (self.new(f"load {MASK}, ptr {slot}"),))

    def _choice(self, test: ast.expr, body: ast.expr, orelse: ast.expr, node: ast.expr) -> Value:
        decided = self.truth(test)
        if decided.known is not None:
            return self.expression(body if decided.known else orelse)
        where, before = self.as_kind(decided, TRUTHS).parts[0], self.mask()
        self.set_mask(self.both(before, where))
        one = self.expression(body)
        self.set_mask(self.without(before, where))
        other = self.expression(orelse)
        self.set_mask(before)
        if decided.kind == TRUTH and one.kind == other.kind and one.kind in OF_LANES and one.kind != FLOAT:
            return self.chosen(decided, one, other)
        for each in (one, other):
            self.of_numbers(each, node)
        return self.chosen(Value(TRUTHS, (where,)), one, other)
