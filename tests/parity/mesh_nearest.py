"""Where a convex mesh and another shape touch: the least way out of each other, or the least distance.

Geometry alone, by trying everything, so that it does not depend on how a search goes; nothing of it is MuJoCo's but
what a touch is told by. What MuJoCo makes of a touch is in `mesh_rules.py`. Lengths are in metres, everything is in the
frame of the world.

A hull here is any object with

    vertices            [n, 3]
    triangles           [t, 3] numbers of vertices, counterclockwise seen from outside
    triangle_normals    [t, 3] unit, outward
    edges               [e, 2] numbers of vertices
    edge_triangles      [e, 2] numbers of the triangles on both sides

and a shape any with `support(directions)`: its furthest point in each direction.
"""

import itertools
from typing import NamedTuple

import numpy as np

#: Halvings of an interval in which a root was found; it is as exact as its numbers then.
HALVINGS = 80
#: Into how many pieces the arc between the normals of two faces is divided to look for least overlaps.
ARC_PIECES = 32
#: What a cosine may be off by rounding, or a distance in metres.
ROUNDING = 1e-12
#: A normal is level, that is, square to an axis, if its cosine with it is less.
LEVEL = 1e-9


class Touch(NamedTuple):
    """The least way out of each other, or, with a negative `depth`, the least distance."""

    depth: float
    #: Unit, from the first to the second.
    normal: np.ndarray
    #: The point of each that touches.
    first: np.ndarray
    second: np.ndarray
    #: Vertex (one number), edge (two) or triangle (three) of each that touches; of what is no hull, see the function.
    first_feature: tuple
    second_feature: tuple

    def swapped(self):
        return Touch(self.depth, -self.normal, self.second, self.first, self.second_feature, self.first_feature)


def dot(a, b):
    return (a * b).sum(-1)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1)[..., None]


def bisected(function, low, high):
    """Where functions change signs between `low` and `high`, arrays of parameters."""
    sign = np.sign(function(low))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        same = np.sign(function(middle)) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return 0.5 * (low + high)


def lines_meet(point, direction, other, other_direction):
    """Parameters along two lines at which they are nearest to each other."""
    lines = np.stack([direction, -other_direction], 1)
    return np.linalg.lstsq(lines, other - point, rcond=None)[0]


# --- Two hulls that overlap


def face_in_vertex(one, other):
    """The face of one hull that is the least way to push a vertex of the other out of it."""
    heights = other.vertices @ one.triangle_normals.T
    overlap = dot(one.vertices[one.triangles[:, 0]], one.triangle_normals) - heights.min(0)
    face = int(overlap.argmin())
    vertex = int(heights[:, face].argmin())
    normal, second = one.triangle_normals[face], other.vertices[vertex]
    depth = overlap[face]
    return Touch(depth, normal, second + depth * normal, second, tuple(one.triangles[face]), (vertex,))


def arcs(hull, inward=False):
    """The normals on both sides of each edge, ends of its arc on the sphere of directions, and the edges as vectors."""
    sign = -1.0 if inward else 1.0
    begin, end = (sign * hull.triangle_normals[hull.edge_triangles[:, side]] for side in (0, 1))
    return begin, end, hull.vertices[hull.edges[:, 1]] - hull.vertices[hull.edges[:, 0]]


def crossing_arcs(one, other):
    """Pairs of edges whose planes are faces of the Minkowski difference: their arcs cross on one half of the sphere."""
    begin, end, edges = arcs(one)
    other_begin, other_end, other_edges = arcs(other, inward=True)
    side_begin, side_end = edges @ other_begin.T, edges @ other_end.T
    other_side_begin, other_side_end = begin @ other_edges.T, end @ other_edges.T
    turn = np.sign(dot(np.cross(begin, end), edges))[:, None]
    other_turn = np.sign(dot(np.cross(other_begin, other_end), other_edges))[None, :]
    one_half = side_end * turn * other_side_begin * other_turn > 0
    return np.nonzero((side_begin * side_end < 0) & (other_side_begin * other_side_end < 0) & one_half)


def edge_in_edge(one, other):
    """The pair of edges that is the least way out of each other, or nothing."""
    i, j = crossing_arcs(one, other)
    if not len(i):
        return []
    begin, end, edges = (each[i] for each in arcs(one))
    other_edges = arcs(other)[2][j]
    normals = unit(np.cross(edges, other_edges))
    normals *= np.sign(dot(normals, begin + end))[:, None]
    point, other_point = one.vertices[one.edges[i, 0]], other.vertices[other.edges[j, 0]]
    overlap = dot(point - other_point, normals)
    k = int(overlap.argmin())
    s, t = lines_meet(point[k], edges[k], other_point[k], other_edges[k])
    first, second = point[k] + s * edges[k], other_point[k] + t * other_edges[k]
    return [Touch(overlap[k], normals[k], first, second, tuple(one.edges[i[k]]), tuple(other.edges[j[k]]))]


def hulls_overlap(one, other):
    """The least way out of each other of two hulls.

    A negative depth says no more than that they are at least as far apart.
    """
    found = [face_in_vertex(one, other), face_in_vertex(other, one).swapped(), *edge_in_edge(one, other)]
    return min(found, key=lambda touch: touch.depth)


# --- Two hulls that are apart, or a segment (`vertices` and `edges` alone) and a hull


def vertex_over_face(one, other):
    """The vertex of one that is nearest to a triangle of the other, of those right over it; or nothing."""
    corners = other.vertices[other.triangles]
    heights = one.vertices @ other.triangle_normals.T - dot(corners[:, 0], other.triangle_normals)
    over = heights > 0
    for side in range(3):
        begin, end = corners[:, side], corners[:, (side + 1) % 3]
        inward = np.cross(other.triangle_normals, end - begin)
        over &= one.vertices @ inward.T >= dot(begin, inward)
    if not over.any():
        return []
    heights = np.where(over, heights, np.inf)
    vertex, face = np.unravel_index(heights.argmin(), heights.shape)
    height, normal, first = heights[vertex, face], other.triangle_normals[face], one.vertices[vertex]
    return [Touch(-height, -normal, first, first - height * normal, (int(vertex),), tuple(other.triangles[face]))]


def nearest_on_segments(between, edge, other_edge):
    """Parameters from 0 to 1 of the nearest points of segments; `between` is from the second's start to the first's."""
    square, other_square, mixed = dot(edge, edge), dot(other_edge, other_edge), dot(edge, other_edge)
    along, other_along = dot(between, edge), dot(between, other_edge)
    determinant = square * other_square - mixed * mixed
    crossing = determinant > 0
    s = np.where(crossing, (mixed * other_along - along * other_square) / np.where(crossing, determinant, 1), 0)
    s = np.clip(s, 0, 1)
    free = (mixed * s + other_along) / other_square
    t = np.clip(free, 0, 1)
    return np.where(t == free, s, np.clip((mixed * t - along) / square, 0, 1)), t


def part_of_edge(edge, parameter):
    """The feature that a point of an edge belongs to: a vertex at its ends, else the edge."""
    return {0.0: tuple(edge[:1]), 1.0: tuple(edge[1:])}.get(parameter, tuple(edge))


def edge_to_edge(one, other):
    """The two edges that are nearest to each other."""
    begin, other_begin = one.vertices[one.edges[:, 0]][:, None], other.vertices[other.edges[:, 0]][None]
    edge = one.vertices[one.edges[:, 1]][:, None] - begin
    other_edge = other.vertices[other.edges[:, 1]][None] - other_begin
    s, t = nearest_on_segments(begin - other_begin, edge, other_edge)
    first, second = begin + s[..., None] * edge, other_begin + t[..., None] * other_edge
    distances = np.linalg.norm(second - first, axis=-1)
    k = np.unravel_index(distances.argmin(), distances.shape)
    features = part_of_edge(one.edges[k[0]], s[k]), part_of_edge(other.edges[k[1]], t[k])
    return Touch(-distances[k], (second[k] - first[k]) / distances[k], first[k], second[k], *features)


def apart(one, other):
    """The nearest points of two hulls, or of a segment and a hull, that do not overlap."""
    over = vertex_over_face(one, other)
    if len(one.triangles):
        over += [touch.swapped() for touch in vertex_over_face(other, one)]
    edges = edge_to_edge(one, other)
    best = max([*over, edges], key=lambda touch: touch.depth)
    # A face is named before the edges that bound it.
    return next((touch for touch in over if touch.depth >= best.depth - ROUNDING), best)


def hulls(one, other, reach):
    """How two hulls touch that overlap or are less than `reach` (m) apart, else nothing."""
    touch = hulls_overlap(one, other)
    if touch.depth <= 0 and -touch.depth < reach:
        touch = apart(one, other)
    return touch if touch.depth > 0 or -touch.depth < reach else None


# --- A shape and a hull: least overlaps over all directions


def overlaps(shape, hull, normals):
    """How far a shape and a hull overlap along each normal, which points from the shape to the hull."""
    return dot(normals, shape.support(normals)) - (normals @ hull.vertices.T).min(1)


def on_shape(shape, normal, depth, feature):
    """A touch at a point of the shape that is known by its normal."""
    first = shape.support(normal)
    return Touch(depth, normal, first, first - depth * normal, (), feature)


def at_vertex(hull, normal, depth, vertex):
    """A touch at a vertex of the hull."""
    second = hull.vertices[vertex]
    return Touch(depth, normal, second + depth * normal, second, (), (int(vertex),))


def against_faces(shape, hull):
    """The least overlap along a normal of the hull's faces."""
    normals = -hull.triangle_normals
    overlap = overlaps(shape, hull, normals)
    face = int(overlap.argmin())
    return on_shape(shape, normals[face], overlap[face], tuple(hull.triangles[face]))


def against_vertices(shape, hull, normals, vertices):
    """The least overlap along normals that each belong to a vertex, where that is the hull's deepest; or nothing."""
    heights = normals @ hull.vertices.T
    deepest = heights[np.arange(len(vertices)), vertices] <= heights.min(1) + ROUNDING
    normals, vertices = normals[deepest], vertices[deepest]
    if not len(vertices):
        return []
    overlap = overlaps(shape, hull, normals)
    k = int(overlap.argmin())
    return [at_vertex(hull, normals[k], overlap[k], vertices[k])]


def against_edges(shape, hull):
    """The least overlap along normals within the arcs of edges at which it is least along the arc; or nothing."""
    begin, end, _ = arcs(hull, inward=True)
    corner = hull.vertices[hull.edges[:, 0]]

    def normal_at(edge, t):
        return unit(begin[edge] * (1 - t)[..., None] + end[edge] * t[..., None])

    def slope(edge, t):
        normal, chord = normal_at(edge, t), end[edge] - begin[edge]
        along = chord - dot(chord, normal)[..., None] * normal
        return dot(shape.support(normal) - corner[edge], along)

    places = np.linspace(0, 1, ARC_PIECES + 1)
    slopes = slope(np.arange(len(begin))[:, None], places[None])
    edge, piece = np.nonzero((slopes[:, :-1] < 0) & (slopes[:, 1:] > 0))
    if not len(edge):
        return []
    normals = normal_at(edge, bisected(lambda t: slope(edge, t), places[piece], places[piece + 1]))
    overlap = dot(normals, shape.support(normals) - corner[edge])
    k = int(overlap.argmin())
    return [on_shape(shape, normals[k], overlap[k], tuple(hull.edges[edge[k]]))]


def against_line(hull, axis, line_of):
    """The least overlap of edges and a line with the direction `axis`, or nothing.

    The normal is square to both, and lies on the arc of the edge; `line_of(normals)` tells a point of the line.
    """
    begin, end, edges = arcs(hull, inward=True)
    rise, other_rise = begin @ axis, end @ axis
    crossing = np.nonzero(rise * other_rise < 0)[0]
    if not len(crossing):
        return []
    t = (rise / np.where(rise == other_rise, 1, rise - other_rise))[crossing][:, None]
    normals = begin[crossing] * (1 - t) + end[crossing] * t
    normals = unit(normals - (normals @ axis)[:, None] * axis)
    points, corners = line_of(normals), hull.vertices[hull.edges[crossing, 0]]
    overlap = dot(normals, points - corners)
    k = int(overlap.argmin())
    edge = edges[crossing[k]]
    s, t = lines_meet(points[k], axis, corners[k], edge)
    return [
        Touch(overlap[k], normals[k], points[k] + s * axis, corners[k] + t * edge, (), tuple(hull.edges[crossing[k]]))
    ]


def least(touches):
    return min(touches, key=lambda touch: touch.depth)


# --- Segments, cylinders, ellipsoids


def segment(shape, hull):
    """How a segment (the axis of a capsule) and a hull touch, wherever they are."""
    line = against_line(hull, shape.axis, lambda normals: np.broadcast_to(shape.position, normals.shape))
    touch = least([against_faces(shape, hull), *line])
    return touch if touch.depth > 0 else apart(shape, hull)


def cylinder(shape, hull):
    """How a cylinder and a hull touch, wherever they are."""
    axis = shape.axis
    side = hull.vertices - shape.position
    side = unit(side - (side @ axis)[:, None] * axis)
    caps = np.stack([axis, -axis])
    overlap = overlaps(shape, hull, caps)
    cap = int(overlap.argmin())
    return least(
        [
            at_vertex(hull, caps[cap], overlap[cap], (hull.vertices @ caps[cap]).argmin()),
            against_faces(shape, hull),
            *against_vertices(shape, hull, side, np.arange(len(side))),
            *against_vertices(shape, hull, *rim_to_vertices(shape, hull)),
            *against_line(hull, axis, lambda normals: shape.position + shape.radius * normals),
            *(touch for touch in against_edges(shape, hull) if abs(touch.normal @ axis) > LEVEL),
        ]
    )


def rim_to_vertices(shape, hull):
    """Normals from the rim of a cylinder to vertices that it is nearest to, and these vertices."""
    local = (hull.vertices - shape.position) @ shape.rotation
    from_axis = np.hypot(local[:, 0], local[:, 1])
    vertices = np.nonzero((from_axis > shape.radius) & (np.abs(local[:, 2]) > shape.half_length))[0]
    local, from_axis = local[vertices], from_axis[vertices]
    on_rim = local * (shape.radius / from_axis)[:, None]
    on_rim[:, 2] = np.sign(local[:, 2]) * shape.half_length
    return unit(local - on_rim) @ shape.rotation.T, vertices


def ellipsoid(shape, hull):
    """How an ellipsoid and a hull touch, wherever they are."""
    normals, vertices = ellipsoid_normals(shape, hull)
    return least(
        [
            against_faces(shape, hull),
            *against_vertices(shape, hull, normals, vertices),
            *against_edges(shape, hull),
        ]
    )


def ellipsoid_normals(shape, hull):
    """Normals of an ellipsoid that pass through vertices, and these vertices.

    In its own frame the normal through y has the direction of y / (a² + t), a being the semi-axes, where the sum of
    (a y / (a² + t))² is one.
    """
    local = (hull.vertices - shape.position) @ shape.rotation
    squares = shape.radii**2

    def excess(points, t):
        with np.errstate(divide="ignore", invalid="ignore"):
            return dot(squares * points**2, 1 / (squares + t[..., None]) ** 2) - 1

    def slope(t):
        with np.errstate(divide="ignore", invalid="ignore"):
            return -dot(squares * local**2, 1 / (squares + t[..., None]) ** 3)

    # The nearest point of the surface has the root that is greater than all poles.
    shortest = int(squares.argmin())
    low = np.abs(local[:, shortest]) * shape.radii[shortest] - squares[shortest]
    high = np.maximum(low, np.sqrt(dot(squares, local**2)))
    vertices, roots = np.arange(len(local)), bisected(lambda t: excess(local, t), low, high)
    # Of a vertex deep inside, a surface point further away may be the one that counts. Between two poles the sum is
    # convex.
    poles = np.sort(-squares)
    for low, high in itertools.pairwise(poles):
        low, high = np.full(len(local), low), np.full(len(local), high)
        least = bisected(slope, low, high)
        inner = np.nonzero(excess(local, least) < 0)[0]
        for ends in [(low[inner], least[inner]), (least[inner], high[inner])]:
            vertices = np.concatenate([vertices, inner])
            roots = np.concatenate([roots, bisected(lambda t, points=local[inner]: excess(points, t), *ends)])
    return unit(local[vertices] / (squares + roots[:, None])) @ shape.rotation.T, vertices
