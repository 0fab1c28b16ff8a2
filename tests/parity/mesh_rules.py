"""Contacts of convex meshes as MuJoCo 4.0 makes them: its rules, found by trying it, and written anew.

`docs/mesh-contacts.md` tells them in words, `test_mesh_rules.py` holds them against MuJoCo. A function for each pair of
shapes takes both as they are placed in the world, the first with the lower type of geom, and the margin of the pair,
and gives a list of `Contact`. Lengths are in metres, everything is in the frame of the world. MuJoCo's own search for
the least way out ends at a tolerance; here it is exact (`mesh_nearest.py`), so that both agree where `ccd_tolerance` is
small.
"""

import copy
from typing import NamedTuple

import mesh_nearest
import numpy as np

#: Two faces lie on each other if the cosine between one's normal and the other's opposite is greater: 5.13 degrees.
FACING_COSINE = 0.996
#: An edge lies along a face if its direction's cosine with the face's normal is less: 5.09 degrees. A face that lies on
#: another has at least this cosine with the direction towards it.
LYING_COSINE = 0.0888
#: So many contacts has a pair at most.
MOST_CONTACTS = 4
#: Of so many polygons is an edge, and a triangle, a part at most; the key is the number of vertices.
MOST_FACES = {2: 2, 3: 1}
#: Corners of the polygon that stands for the end of a cylinder.
CAP_CORNERS = 16
#: What is less than this outside the face that clips is inside (m); a guess, on which nothing depends but exact ties.
ROUNDING = 1e-15
#: A cylinder stands on its end if the cosine between its axis and the normal of the touch is this near to one.
STANDING = 1e-12


class Contact(NamedTuple):
    #: Negative in each other.
    dist: float
    #: Middle between the points of both.
    pos: np.ndarray
    #: Unit, from the first geom to the second: the first row of MuJoCo's `frame`.
    normal: np.ndarray


class Face(NamedTuple):
    #: [n, 3], clockwise seen from outside, as MuJoCo lays them out.
    corners: np.ndarray
    #: Unit, outward.
    normal: np.ndarray

    def height(self, point):
        return (point - self.corners[0]) @ self.normal


# --- Shapes


class Polytope:
    """A convex mesh, a hull of `mesh_nearest.py`, with polygons: triangles of the hull that MuJoCo merged."""

    def __init__(self, vertices, triangles, polygons, polygon_normals, polygons_at):
        self.vertices = vertices
        self.triangles = triangles
        self.edges, self.edge_triangles = edges_of(triangles)
        corners = vertices[triangles]
        self.triangle_normals = mesh_nearest.unit(
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        )
        #: Numbers of vertices, counterclockwise seen from outside.
        self.polygons = polygons
        self.polygon_normals = polygon_normals
        #: Polygons around each vertex, in MuJoCo's order, in which it looks for the first that fits.
        self.polygons_at = polygons_at

    def placed(self, rotation, position):
        """The same in the world. `rotation` is [3, 3] or flat, rows first, `position` the origin of the frame."""
        there = copy.copy(self)
        rotation = np.reshape(rotation, (3, 3))
        there.position = np.array(position)
        there.vertices = self.vertices @ rotation.T + there.position
        there.triangle_normals = self.triangle_normals @ rotation.T
        there.polygon_normals = self.polygon_normals @ rotation.T
        return there

    def face(self, polygon):
        return Face(self.vertices[self.polygons[polygon][::-1]], self.polygon_normals[polygon])

    def faces_at(self, feature):
        """Polygons that a feature belongs to: all around a vertex, two beside an edge, one of a triangle.

        An edge within a merged polygon has that alone. Where three have both ends of an edge, the first two of its
        first vertex count.
        """
        around = self.polygons_at[feature[0]]
        if len(feature) > 1:
            around = [polygon for polygon in around if set(feature) <= set(self.polygons[polygon])]
            around = around[: MOST_FACES[len(feature)]]
        return [self.face(polygon) for polygon in around]

    def edges_at(self, feature):
        """An edge itself; of a vertex, in each polygon around it, the edge to the corner before. Two ends each."""
        ends = feature[1:]
        if not ends:
            polygons = [self.polygons[polygon] for polygon in self.polygons_at[feature[0]]]
            ends = [polygon[polygon.index(feature[0]) - 1] for polygon in polygons]
        return [self.vertices[[feature[0], end]] for end in ends]


def edges_of(triangles):
    """Edges of a closed surface, and the two triangles of each."""
    begun, edges, sides = {}, [], []
    for number, (a, b, c) in enumerate(triangles):
        for begin, end in ((a, b), (b, c), (c, a)):
            if (end, begin) in begun:
                edges.append((end, begin))
                sides.append((begun[end, begin], number))
            else:
                begun[begin, end] = number
    return np.array(edges), np.array(sides)


def poly_from_model(model, mesh):
    """The polytope of a mesh of a compiled model: its hull, in the frame that the compiler gave the mesh."""
    first, graph = model.mesh_vertadr[mesh], model.mesh_graph[model.mesh_graphadr[mesh] :]
    vertex_count, triangle_count = graph[:2]
    # Of the mesh, those on the hull; behind them stand neighbours of each, and triangles.
    on_hull = graph[2 + vertex_count : 2 + 2 * vertex_count]
    triangles = graph[2 + 3 * (vertex_count + triangle_count) :][: 3 * triangle_count].reshape(-1, 3)
    number = {int(vertex): i for i, vertex in enumerate(on_hull)}

    def part(values, begin, count):
        return values[begin : begin + count].tolist()

    polygons = range(model.mesh_polyadr[mesh], model.mesh_polyadr[mesh] + model.mesh_polynum[mesh])
    corners = [part(model.mesh_polyvert, model.mesh_polyvertadr[i], model.mesh_polyvertnum[i]) for i in polygons]
    around = [part(model.mesh_polymap, model.mesh_polymapadr[i], model.mesh_polymapnum[i]) for i in first + on_hull]
    return Polytope(
        vertices=model.mesh_vert[first + on_hull].astype(float),
        triangles=np.array([[number[vertex] for vertex in triangle] for triangle in triangles.tolist()]),
        polygons=[[number[vertex] for vertex in polygon] for polygon in corners],
        polygon_normals=model.mesh_polynormal[polygons].astype(float),
        polygons_at=around,
    )


class Shape:
    """A shape in the world: its middle, and its axes as columns of `rotation`."""

    def __init__(self, rotation, position):
        self.rotation = np.reshape(rotation, (3, 3)).copy()
        self.position = np.array(position)
        self.axis = self.rotation[:, 2]


class Plane(Shape):
    """The half space below its frame's z."""


class Capsule(Shape):
    """All that is within `radius` of a segment; as a shape of `mesh_nearest.py` the segment alone."""

    def __init__(self, rotation, position, radius, half_length):
        super().__init__(rotation, position)
        self.radius, self.half_length = radius, half_length
        self.vertices = self.position + np.outer([-half_length, half_length], self.axis)
        self.edges, self.triangles = np.array([[0, 1]]), ()

    def support(self, directions):
        return self.vertices[(directions @ self.axis > 0).astype(int)]

    def line(self, height, direction):
        """The segment moved away from the axis by `height` times what of a direction is square to it."""
        away = height * direction
        return self.vertices + away - (away @ self.axis) * self.axis


class Cylinder(Shape):
    def __init__(self, rotation, position, radius, half_length):
        super().__init__(rotation, position)
        self.radius, self.half_length = radius, half_length

    def support(self, directions):
        local = directions @ self.rotation
        across = np.hypot(local[..., 0], local[..., 1])
        # Of an end that faces straight there its middle.
        scale = self.radius / np.where(across > ROUNDING, across, np.inf)
        top = np.where(local[..., 2] >= 0, self.half_length, -self.half_length)
        return np.stack([local[..., 0] * scale, local[..., 1] * scale, top], -1) @ self.rotation.T + self.position

    def outward(self, normal):
        """Direction of the end that a normal points out of: 1 along the axis, -1 against it."""
        return 1.0 if normal @ self.axis >= 0 else -1.0

    def cap(self, normal):
        """The end that a normal points out of, as a polygon on its rim."""
        outward = self.outward(normal)
        angle = 2 * np.pi * np.arange(CAP_CORNERS) / CAP_CORNERS
        x, y = self.radius * np.cos(angle), -outward * self.radius * np.sin(angle)
        local = np.stack([x, y, np.full(CAP_CORNERS, outward * self.half_length)], 1)
        return Face(local @ self.rotation.T + self.position, outward * self.axis)

    def side_line(self, normal):
        """The line of the side that a normal points out of, from its end to the other."""
        along = self.outward(normal) * self.half_length * self.axis
        on_rim = self.support(normal)
        across = on_rim - self.position - ((on_rim - self.position) @ self.axis) * self.axis
        return np.stack([self.position + across + along, self.position + across - along])


class Ellipsoid(Shape):
    def __init__(self, rotation, position, radii):
        super().__init__(rotation, position)
        self.radii = np.array(radii)

    def support(self, directions):
        scaled = directions @ self.rotation * self.radii
        return mesh_nearest.unit(scaled) * self.radii @ self.rotation.T + self.position


# --- What lies on what


def faces_on_each_other(faces, other_faces, normal):
    """The two faces that face each other most squarely, or nothing."""
    best, found = -FACING_COSINE, None
    for face in faces:
        for other in other_faces:
            turned = face.normal @ normal > LYING_COSINE and other.normal @ normal < -LYING_COSINE
            if turned and face.normal @ other.normal < best:
                best, found = face.normal @ other.normal, (face, other)
    return found


def edge_on_face(edges, faces, towards):
    """The first face turned towards a direction that an edge lies along, behind the first such edge; or nothing."""
    for face in faces:
        if face.normal @ towards <= ROUNDING:
            continue
        for edge in edges:
            if abs(mesh_nearest.unit(edge[1] - edge[0]) @ face.normal) < LYING_COSINE:
                return edge, face
    return None


def cut(polygon, corner, inward):
    """The part of a polygon on one side of a plane through a corner (Sutherland and Hodgman)."""
    kept = []
    inside = [inward @ (point - corner) > -ROUNDING for point in polygon]
    for i, begin in enumerate(polygon):
        following = (i + 1) % len(polygon)
        end = polygon[following]
        if inside[i] != inside[following]:
            rise = inward @ (end - begin)
            t = (inward @ corner - inward @ begin) / rise if rise else np.inf
            if 0 <= t <= 1:
                kept.append(begin + t * (end - begin))
        if inside[following]:
            kept.append(end)
    return kept


def clipped(polygon, face, height):
    """Corners of what of a polygon, or of a segment taken for one, is right over or under a face, up to a height."""
    for i, begin in enumerate(face.corners):
        end = face.corners[(i + 1) % len(face.corners)]
        polygon = cut(polygon, begin, mesh_nearest.unit(np.cross(end - begin, face.normal)))
    return [point for point in polygon if face.height(point) <= height]


# --- Four of many corners


def quad_area(points, quad):
    a, b, c, d = (points[i] for i in quad)
    return 0.5 * np.linalg.norm(np.cross(c - a, d - b))


def moved_on(points, quad, corner, area):
    """A quadrilateral with one corner moved on to the next point, and its area, if that is greater; else nothing."""
    moved = list(quad)
    moved[corner] = (moved[corner] + 1) % len(points)
    larger = quad_area(points, moved)
    return (moved, larger) if larger > area else None


def grown(points, quad, area):
    """A quadrilateral whose corners but the first were moved on as long as it became larger, and its area."""
    while moved := moved_on(points, quad, 3, area):
        quad, area = moved
        for corner in (2, 1):
            while further := moved_on(points, quad, corner, area):
                quad, area = further
    return quad, area


def quad_through(points, first):
    """Numbers of the four corners of a convex polygon with which a quadrilateral through one of them becomes large."""
    quad = [(first + i) % len(points) for i in range(4)]
    return grown(points, quad, quad_area(points, quad))[0]


def large_quad(points):
    """Numbers of four corners of a convex polygon that span a large quadrilateral, nearly always the largest.

    One corner goes all round and pushes the others; those are moved on as long as the area grows, as calipers turn.
    """
    quad = [0, 1, 2, 3]
    best, area = quad, quad_area(points, quad)
    for first in range(len(points)):
        quad, larger = grown(points, [first, *quad[1:]], area)
        if larger > area:
            best, area = quad, larger
        for corner in (1, 2, 3):
            if quad[corner] != quad[corner - 1]:
                break
            quad = [*quad[:corner], (quad[corner] + 1) % len(points), *quad[corner + 1 :]]
    return best


# --- Contacts of a touch


def single(touch, radius=0.0):
    """The one contact of a touch, the first shape grown by a radius."""
    middle = 0.5 * (touch.first + radius * touch.normal + touch.second)
    return [Contact(-touch.depth - radius, middle, touch.normal)]


def face_contacts(face, other, margin):
    """Contacts of two faces: of the second's corners, clipped by the first, against the first.

    Distances are along the normal of the second, which is the contacts', too.
    """
    points = clipped(other.corners, face, margin)
    if len(points) > MOST_CONTACTS:
        points = [points[i] for i in large_quad(points)]
    feet = [(point, point - face.height(point) * face.normal) for point in points]
    dists = [(foot - point) @ other.normal for point, foot in feet]
    return [Contact(d, foot - 0.5 * d * other.normal, -other.normal) for d, (_, foot) in zip(dists, feet, strict=True)]


def furthest_two(points):
    """The two of some points that are furthest from each other, the first such."""
    pairs = [(i, j) for i in range(len(points)) for j in range(i + 1, len(points))]
    i, j = max(pairs, key=lambda pair: np.sum((points[pair[1]] - points[pair[0]]) ** 2))
    return [points[i], points[j]]


def edge_contacts(edge, face, margin, sign, outset=0.0):
    """Contacts of an edge that lies along a face: of both ends of what is over it. Normals are the face's times a sign.

    The face is moved out by `outset`.
    """
    points = clipped(edge, face, margin)
    if len(points) > 2:
        points = furthest_two(points)
    heights = [face.height(point) + outset for point in points]
    return [
        Contact(height, point + (outset - 0.5 * height) * face.normal, sign * face.normal)
        for height, point in zip(heights, points, strict=True)
    ]


def several(touch, faces, edges, other_faces, other_edges, margin):
    """Contacts of a touch of which each side has these faces, and edges in case that its feature is none itself."""
    if found := faces_on_each_other(faces, other_faces, touch.normal):
        return face_contacts(*found, margin) or single(touch)
    # What is larger than the other's feature is not tried, unless it has no face that the other could lie on.
    smaller = len(touch.first_feature) <= len(touch.second_feature) or not faces
    if smaller and (found := edge_on_face(edges, other_faces, -touch.normal)):
        return edge_contacts(*found, margin, -1.0) or single(touch)
    if found := edge_on_face(other_edges, faces, touch.normal):
        return edge_contacts(*found, margin, 1.0) or single(touch)
    return single(touch)


def edges_at(polytope, feature):
    return polytope.edges_at(feature) if len(feature) < 3 else []


# --- Pairs of shapes


def mesh_mesh(one, other, margin=0.0):
    touch = mesh_nearest.hulls(one, other, margin)
    if touch is None:
        return []
    features = [(one, touch.first_feature), (other, touch.second_feature)]
    (faces, edges), (other_faces, other_edges) = ((hull.faces_at(f), edges_at(hull, f)) for hull, f in features)
    return several(touch, faces, edges, other_faces, other_edges, margin)


def plane_mesh(plane, mesh, margin=0.0):
    """The deepest vertex, and corners of the polygon there that faces the plane most squarely.

    Of these those within the margin alone, and none that is higher than the origin of the mesh's frame. A vertex that
    no polygon has lies alone.
    """
    normal = plane.axis
    heights = (mesh.vertices - plane.position) @ normal
    deepest = int(heights.argmin())
    if heights[deepest] > margin:
        return []
    others = corners_after(mesh, deepest, normal)
    low = [i for i in others if heights[i] <= margin and (mesh.vertices[i] - mesh.position) @ normal <= 0]
    return [Contact(heights[i], mesh.vertices[i] - 0.5 * heights[i] * normal, normal) for i in [deepest, *low]]


def corners_after(mesh, vertex, normal):
    """The other corners, at most three, of the polygon at a vertex that is turned most against a direction."""
    around = mesh.polygons_at[vertex]
    if not around:
        return []
    polygon = mesh.polygons[min(around, key=lambda i: mesh.polygon_normals[i] @ normal)]
    start, count = polygon.index(vertex), len(polygon)
    corners = [(start + i) % count for i in range(count)]
    if count > MOST_CONTACTS:
        corners = quad_through(mesh.vertices[polygon], start)
    return [polygon[i] for i in corners[1:]]


def cylinder_mesh(cylinder, mesh, margin=0.0):
    """Where an end of the cylinder takes part, this is MuJoCo's. Of its side two things are not reproduced.

    The line of the side goes through the rim point that touches, which is exact here, and in MuJoCo what its search
    ended with (to 1e-6 or 1e-5 m with a small tolerance). And where the cylinder stands on a vertex, any line of its
    side would do. MuJoCo tries one that is left over from its search; if that lies along a steep face of the mesh, all
    of it is clipped away, and the single contact kept. In some two of 30,000 pairs the line is over the steep face, and
    contacts come out that are up to metres deep.
    """
    touch = mesh_nearest.cylinder(cylinder, mesh)
    if touch.depth <= -margin:
        return []
    normal, feature = touch.normal, touch.second_feature
    upright = abs(normal @ cylinder.axis)
    level = upright < mesh_nearest.LEVEL
    # The side counts as an edge without a face, an end as a vertex with one.
    touch = touch._replace(first_feature=(0, 1) if level else (0,))
    faces = [] if level else [cylinder.cap(normal)]
    line, other_faces = cylinder.side_line(normal), mesh.faces_at(feature)
    standing = upright > 1 - STANDING and len(feature) == 1
    if standing and not faces_on_each_other(faces, other_faces, normal) and edge_on_face([line], other_faces, -normal):
        return single(touch)
    return several(touch, faces, [line], other_faces, edges_at(mesh, feature), margin)


def capsule_mesh(capsule, mesh, margin=0.0):
    """A capsule lies on a face with the line of its surface, half a margin outside; it has no faces of its own."""
    touch = mesh_nearest.segment(capsule, mesh)
    if touch.depth + capsule.radius <= -margin:
        return []
    ends = capsule.line(capsule.radius + 0.5 * margin, touch.normal)
    found = edge_on_face([ends], mesh.faces_at(touch.second_feature), -touch.normal)
    contacts = edge_contacts(*found, 0.5 * margin, -1.0, outset=0.5 * margin) if found else []
    return contacts or single(touch, capsule.radius)


def ellipsoid_mesh(ellipsoid, mesh, margin=0.0):
    """Always one contact."""
    touch = mesh_nearest.ellipsoid(ellipsoid, mesh)
    return single(touch) if touch.depth > -margin else []
