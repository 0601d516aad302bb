"""A small path tracer for pictures of the robot: numpy for shading, Embree (embreex) for ray casts.

Diffuse surfaces under a clear coat, lit by distant soft lights and an ambient sky, and one translucent ball. Lights are
sampled directly by diffuse reflection and seen by glossy reflection (Pharr, Jakob, Humphreys, "Physically Based
Rendering", multiple-lobe path tracing). Vectors are rows of (n, 3) arrays, world frame, metres; colours linear RGB.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from robots.scene import Triangles

Array = npt.NDArray[np.float64]
Rgb = tuple[float, float, float]
Vec3 = tuple[float, float, float]
BOUNCES = 4
OFFSET = 2e-5  # m, keeps rays off the surface that they leave


@dataclass(frozen=True)
class Material:
    """Base colour, reflectance at normal incidence and roughness (0 mirror .. 1) of the coat."""

    colour: Rgb
    f0: float = 0.04
    roughness: float = 0.25


@dataclass(frozen=True)
class Light:
    """Distant round light: direction towards it, radiance, angular radius (rad)."""

    direction: Vec3
    radiance: Rgb
    radius: float


@dataclass(frozen=True)
class Ball:
    """Translucent sphere: light scatters on it with probability `opacity`, else it passes, tinted."""

    centre: Vec3
    radius: float
    colour: Rgb
    opacity: float
    glow: float


@dataclass(frozen=True)
class Camera:
    eye: Vec3
    target: Vec3
    fov_degrees: float  # vertical
    width: int
    height: int

    def rays(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """One ray per pixel, at a random place in it: origins and unit directions, row by row from the top left."""
        eye = np.array(self.eye)
        ahead = unit(np.array(self.target) - eye)
        right = unit(np.cross(ahead, [0.0, 0.0, 1.0]))
        up = np.cross(right, ahead)
        scale = 2 * np.tan(np.radians(self.fov_degrees) / 2) / self.height
        y, x = np.mgrid[0 : self.height, 0 : self.width].reshape(2, -1) + rng.random((2, self.width * self.height))
        u, v = (x - self.width / 2) * scale, (self.height / 2 - y) * scale
        d = unit(ahead + u[:, None] * right + v[:, None] * up)
        return np.broadcast_to(eye, d.shape).copy(), d


@dataclass(frozen=True)
class Hits:
    """Nearest hits of rays; `found` marks those that hit anything, `ball` those that met the ball first."""

    found: npt.NDArray[np.bool_]
    ball: npt.NDArray[np.bool_]
    t: Array
    normal: Array  # shading normal, towards the ray's origin
    material: npt.NDArray[np.int64]

    def where(self, keep: npt.NDArray[np.bool_]) -> Hits:
        return Hits(self.found[keep], self.ball[keep], self.t[keep], self.normal[keep], self.material[keep])


def unit(v: Array) -> Array:
    return v / np.sqrt((v * v).sum(-1, keepdims=True))


def around(n: Array, cos_theta: Array, turn: Array) -> Array:
    """Directions at polar angle theta about the unit rows n, azimuth `turn` of a revolution.

    The frame is that of Duff et al. 2017, "Building an orthonormal basis, revisited".
    """
    sign = np.where(n[:, 2] >= 0, 1.0, -1.0)
    a = -1.0 / (sign + n[:, 2])
    b = n[:, 0] * n[:, 1] * a
    s = np.stack([1 + sign * n[:, 0] ** 2 * a, sign * b, -sign * n[:, 0]], -1)
    t = np.stack([b, sign + n[:, 1] ** 2 * a, -n[:, 1]], -1)
    sin_theta = np.sqrt(np.maximum(0.0, 1 - cos_theta**2))
    phi = 2 * np.pi * turn
    return s * (np.cos(phi) * sin_theta)[:, None] + t * (np.sin(phi) * sin_theta)[:, None] + n * cos_theta[:, None]


class Tracer:
    """Renders one scene; every call of `sample` gives one light sample per camera ray."""

    def __init__(
        self,
        triangles: Triangles,
        materials: dict[str, Material],
        lights: list[Light],
        ball: Ball,
        sky: tuple[Rgb, Rgb],
        floor_fade: tuple[Vec3, float, float],
    ) -> None:
        """`sky`: ambient radiance from below and above. `floor_fade`: centre and radii (m) between which the material
        named "floor" fades into the backdrop."""
        names = list(materials)
        self._scene = EmbreeScene()
        self._mesh = TriangleMesh(self._scene, triangles.corners.astype(np.float32))
        self._normals = triangles.normals
        self._material = np.concatenate([np.full(count, names.index(name)) for name, count in triangles.batches])
        self._colour = np.array([m.colour for m in materials.values()])
        self._f0 = np.array([m.f0 for m in materials.values()])
        self._roughness = np.array([m.roughness for m in materials.values()])
        self._floor = names.index("floor")
        self._lights, self._ball = lights, ball
        self._sky = np.array(sky)
        self._fade = floor_fade

    def _ambient(self, d: Array) -> Array:
        t = np.clip(0.5 + 0.5 * d[:, 2:3], 0, 1)
        t = t * t * (3 - 2 * t)
        return self._sky[0] * (1 - t) + self._sky[1] * t

    def _lit_sky(self, d: Array) -> Array:
        """Ambient plus the lights themselves, with soft rims, as glossy reflections see them."""
        total = self._ambient(d)
        for light in self._lights:
            angle = np.arccos(np.clip(d @ unit(np.array(light.direction)), -1, 1))
            disc = np.clip((light.radius - angle) / (0.25 * light.radius) + 0.5, 0, 1)[:, None]
            total = total + disc * np.array(light.radiance)
        return total

    def _cast(self, o: Array, d: Array) -> Hits:
        result = self._scene.run(o.astype(np.float32), d.astype(np.float32), query="INTERSECT", output=True)
        found = result["primID"] >= 0
        prim = np.where(found, result["primID"], 0)
        t = np.where(found, result["tfar"], np.inf).astype(np.float64)
        u, v = result["u"][:, None].astype(np.float64), result["v"][:, None].astype(np.float64)
        corner = self._normals[prim]
        normal = unit((1 - u - v) * corner[:, 0] + u * corner[:, 1] + v * corner[:, 2] + 1e-12)
        to_centre = np.array(self._ball.centre) - o
        along = (to_centre * d).sum(-1)
        inside = self._ball.radius**2 - (to_centre * to_centre).sum(-1) + along**2
        near = along - np.sqrt(np.maximum(inside, 0))
        ball = (inside > 0) & (near > 1e-4) & (near < t)
        t = np.where(ball, near, t)
        normal = np.where(ball[:, None], (near[:, None] * d - to_centre) / self._ball.radius, normal)
        facing = np.where((normal * d).sum(-1) > 0, -1.0, 1.0)
        return Hits(found | ball, ball, t, normal * facing[:, None], self._material[prim])

    def _direct(self, p: Array, n: Array, rng: np.random.Generator) -> Array:
        """Irradiance / pi from the lights, one shadow ray each."""
        total = np.zeros_like(p)
        for light in self._lights:
            axis = np.broadcast_to(unit(np.array(light.direction)), p.shape)
            solid = 2 * np.pi * (1 - np.cos(light.radius))
            cos_theta = 1 - rng.random(len(p)) * (1 - np.cos(light.radius))
            d = around(axis, cos_theta, rng.random(len(p)))
            cosine = np.maximum((n * d).sum(-1), 0)
            hit = self._cast(p + OFFSET * n, d)
            passed = np.where(hit.ball, 1 - self._ball.opacity, np.where(hit.found, 0.0, 1.0))
            tint = np.where(hit.ball[:, None], np.array(self._ball.colour), 1.0)
            total += (cosine * passed * solid / np.pi)[:, None] * tint * np.array(light.radiance)
        return total

    def _bounce(
        self, d: Array, hit: Hits, colour: Array, lobe: Array, rng: np.random.Generator
    ) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
        """New direction, throughput factor, and whether `lobe` (uniform in 0..1) chose glossy reflection."""
        n = hit.normal
        cosine = np.clip(-(d * n).sum(-1), 0, 1)
        f0 = np.where(hit.ball, 0.04, self._f0[hit.material])
        rough = np.where(hit.ball, 0.05, self._roughness[hit.material])
        fresnel = f0 + (np.maximum(1 - rough, f0) - f0) * (1 - cosine) ** 5
        # Higher odds than the reflectance, weighted back, keep rare bright reflections from showing as specks.
        odds = np.clip(fresnel, 0.25, 0.9)
        glossy = lobe < odds
        u, v = rng.random((2, len(d)))
        # GGX microfacet normal; its masking is left out.
        alpha2 = rough**4
        half = around(n, np.sqrt((1 - u) / (1 + (alpha2 - 1) * u)), v)
        mirrored = d - 2 * (d * half).sum(-1, keepdims=True) * half
        mirrored = np.where((mirrored * n).sum(-1, keepdims=True) > 0, mirrored, d + 2 * cosine[:, None] * n)
        diffuse = around(n, np.sqrt(1 - u), v)
        metal = (f0 > 0.3)[:, None] & glossy[:, None]
        share = np.where(glossy, fresnel / odds, (1 - fresnel) / (1 - odds))[:, None]
        factor = share * np.where(glossy[:, None] & ~metal, 1.0, colour)
        return np.where(glossy[:, None], mirrored, diffuse), factor, glossy

    def sample(
        self, o: Array, d: Array, backdrop: Array, lobe: Array, rng: np.random.Generator
    ) -> tuple[Array, Array, Array]:
        """Radiance, first-hit colour and first-hit normal of camera rays.

        `backdrop` is what the misses show; `lobe` chooses each first reflection: values that spread evenly over 0..1
        from call to call give less noise than random ones.
        """
        count = len(d)
        light, weight = np.zeros((count, 3)), np.ones((count, 3))
        first_colour, first_normal = np.ones((count, 3)), np.zeros((count, 3))
        alive, glossy = np.arange(count), np.ones(count, dtype=bool)
        for bounce in range(BOUNCES):
            hit = self._cast(o, d)
            miss = ~hit.found
            if bounce == 0:
                light[alive[miss]] = backdrop[alive[miss]]
            else:
                seen = np.where(glossy[miss, None], self._lit_sky(d[miss]), self._ambient(d[miss]))
                light[alive[miss]] += weight[alive[miss]] * seen
            keep = hit.found
            hit = hit.where(keep)
            alive, o, d, lobe = alive[keep], o[keep], d[keep], lobe[keep]
            if not len(alive):
                break
            p = o + hit.t[:, None] * d
            colour = np.where(hit.ball[:, None], np.array(self._ball.colour), self._colour[hit.material])
            if bounce == 0:
                first_colour[alive], first_normal[alive] = colour, hit.normal
                fade = self._floor_fade(p, hit)[:, None]
                light[alive] += fade * backdrop[alive]
                weight[alive] *= 1 - fade
            light[alive] += weight[alive] * np.where(hit.ball[:, None], self._ball.glow * colour, 0.0)
            through = hit.ball & (rng.random(len(alive)) >= self._ball.opacity)
            new_d, factor, glossy = self._bounce(d, hit, colour, lobe if bounce == 0 else rng.random(len(d)), rng)
            direct = ~glossy & ~through
            weight[alive] *= np.where(through[:, None], 0.35 + 0.65 * colour, factor)
            light[alive[direct]] += weight[alive[direct]] * self._direct(p[direct], hit.normal[direct], rng)
            # A ray that passes the ball skips to its far side.
            chord = -2 * self._ball.radius * (d * hit.normal).sum(-1)
            o = np.where(through[:, None], p + (chord + 2e-4)[:, None] * d, p + OFFSET * hit.normal)
            d = np.where(through[:, None], d, new_d)
            glossy = glossy | through
        return light, first_colour, first_normal

    def _floor_fade(self, p: Array, hit: Hits) -> Array:
        centre, inner, outer = self._fade
        r = np.sqrt(((p[:, :2] - np.array(centre[:2])) ** 2).sum(-1))
        t = np.clip((r - inner) / (outer - inner), 0, 1)
        return np.where((hit.material == self._floor) & ~hit.ball, t * t * (3 - 2 * t), 0.0)
