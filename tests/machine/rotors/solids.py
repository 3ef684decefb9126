"""Rotors as pixels, for checks that share nothing with the contact chain but the outlines of the rotors.

Both rotors are drawn once in their own frames; a transverse section looks them up, turned, on a grid, and chambers are
connected regions of free pixels.
"""

import math
from functools import lru_cache

import numpy as np
from PIL import Image, ImageDraw
from scipy import ndimage

from screwsim.machine.rotors.pair import outlines

FINE = 0.02e-3  # [m] pixel of a rotor's picture
STEP = 0.1e-3  # [m] pixel of a section


def picture(x, y, radius):
    """Return a boolean picture of a polygon [m] in a square of half-width `radius`, with an empty pixel around it."""
    size = math.ceil(2 * radius / FINE) + 1
    image = Image.new("1", (size, size))
    points = np.column_stack([(x + radius) / FINE, (y + radius) / FINE])
    ImageDraw.Draw(image).polygon([tuple(p) for p in points.tolist()], fill=1)
    return np.pad(np.asarray(image), 1)


class Solids:
    """The pair as pictures; `free(psi)` are the points of both bores outside both rotors at an angle ψ."""

    def __init__(self, rotors):
        self.pair = pair = rotors.pair
        (mx, my), (fx, fy) = outlines(pair, rotors.chain)
        self.male, self.female = picture(mx, my, pair.male_radius), picture(fx, fy, pair.female_radius)
        A, R1, R2 = pair.centre_distance, pair.male_radius, pair.female_radius
        x, y = np.arange(-R1, A + R2, STEP), np.arange(-max(R1, R2), max(R1, R2), STEP)
        self.x, self.y = np.meshgrid(x, y)
        from_male, from_female = np.hypot(self.x, self.y), np.hypot(self.x - A, self.y)
        self.male_bore, self.female_bore = from_male < R1, from_female < R2
        # no rotor reaches further, the thickness of its pixels included: where that is, and these points [m]
        around = np.flatnonzero(from_male < R1 + FINE), np.flatnonzero(from_female < R2 + FINE)
        self.around = [(at, self.x.flat[at], self.y.flat[at]) for at in around]
        self.labels = lru_cache(maxsize=4)(self._labels)  # of the sections that were looked at last

    def in_male(self, x, y, psi):
        """Return which points [m] lie in the male rotor at ψ."""
        c, s = np.cos(psi), np.sin(psi)
        return self._look(self.male, c * x - s * y, s * x + c * y, self.pair.male_radius)

    def in_female(self, x, y, psi):
        """Return which points [m] lie in the female rotor at ψ."""
        c, s = np.cos(self.pair.k * psi), np.sin(self.pair.k * psi)
        x = x - self.pair.centre_distance
        return self._look(self.female, c * x + s * y, c * y - s * x, self.pair.female_radius)

    @staticmethod
    def _look(image, u, v, radius):
        size, places = len(image), []
        for each in (v, u):
            place = each + radius
            place /= FINE
            np.rint(place, out=place)
            places.append(np.clip(place, -1, size - 2, out=place).astype(np.int32) + 1)  # beyond it: the empty edge
        return image.take(places[0] * size + places[1])

    def free(self, psi):
        """Return the free pixels of a section at ψ."""
        found = self.male_bore | self.female_bore
        for (at, x, y), inside in zip(self.around, (self.in_male, self.in_female), strict=True):
            found.flat[at[inside(x, y, psi)]] = False
        return found

    def _labels(self, psi):
        return ndimage.label(self.free(psi))[0]

    def chamber(self, psi, lobe=0):
        """Return the pixels of the chamber ahead of male lobe `lobe` (1: the next one behind), as connected regions.

        It holds what touches the lobe's leading flank near its tip, and the bottom of the groove that lobe enters.
        """
        labels = self.labels(float(psi))
        pair, own = self.pair, psi - lobe * self.pair.pitch
        tip = -np.linspace(0.02, 0.12, 40)  # male frame, ahead of the tip
        seeds = [
            (r * np.cos(a - own), r * np.sin(a - own)) for a in tip for r in pair.male_radius - STEP * np.arange(1, 9)
        ]
        bottom = pair.centre_distance - pair.male_radius + 3 * STEP
        eta = -pair.k * own
        seeds.append((pair.centre_distance - bottom * np.cos(eta), bottom * np.sin(eta)))
        found = set()
        for x, y in seeds:
            found.add(int(labels[self.row(y), self.column(x)]))
        chosen = np.zeros(labels.max() + 1, dtype=bool)
        chosen[sorted(found - {0})] = True
        return chosen[labels]

    def row(self, y):
        """Return the row of the pixels at y [m]."""
        return np.rint((y - self.y[0, 0]) / STEP).astype(int)

    def column(self, x):
        """Return the column of the pixels at x [m]."""
        return np.rint((x - self.x[0, 0]) / STEP).astype(int)
