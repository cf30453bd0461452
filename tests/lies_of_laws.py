"""Lies about drag, about what joints have of their own, and about shapes and planes."""

import numpy as np

from simcompare.model.rotations import matrix_of
from tests.lies import Lie, every, every_moving_body


def of_joints(kind, **changes):
    """Changes in joints of one type alone."""
    changed = {
        name: lambda j, name=name, make=make: make(j) if j.type == kind else getattr(j, name)
        for name, make in changes.items()
    }
    return every("joints", **changed)


def of_shapes(kind, **changes):
    """Changes in shapes of one type, or of all that are no planes; each a function of the shape."""

    def shapes(body):
        return tuple(
            s.model_copy(update={name: make(s) for name, make in changes.items()})
            if s.type == kind or (kind is None and s.type != "plane")
            else s
            for s in body.shapes
        )

    return every("bodies", shapes=shapes)


def scaled(factor):
    return lambda shape: tuple(factor * edge for edge in shape.size_m)


def drag_scaled(factor):
    def drag(body):
        kept = body.drag
        return kept and kept.model_copy(update={"coefficient": factor * kept.coefficient})

    return every_moving_body(drag=drag)


def anchors_in_the_worlds_frame(scenario):
    def anchor(joint):
        parent = matrix_of(scenario.bodies[joint.parent].orientation_wxyz)
        return tuple((parent.T @ joint.anchor_m).tolist())

    return every("joints", anchor_m=anchor)(scenario)


def planes_in_the_worlds_frame(scenario):
    """A plane is where its body is, and does not turn with it."""

    def shapes(body):
        turn = matrix_of(body.orientation_wxyz).T
        return tuple(
            s.model_copy(update={"normal": tuple((turn @ s.normal).tolist())})
            if s.type == "plane"
            else s
            for s in body.shapes
        )

    return every("bodies", shapes=shapes)(scenario)


def flipped(axis):
    return lambda plane: tuple(-v if at == axis else v for at, v in enumerate(plane.normal))


def far_along(plane):
    """The place of a plane at n·p = d where n is taken as it is, and not made a direction."""
    return tuple(float(np.linalg.norm(plane.normal)) * v for v in plane.position_m)


UPRIGHT = (1.0, 0.0, 0.0, 0.0)
ORIGIN = (0.0, 0.0, 0.0)

LAWS = {
    "no drag": Lie("air_slows_what_falls", drag_scaled(0.0)),
    "drag halved": Lie("air_slows_what_falls", drag_scaled(0.5)),
    "area of drag left out": Lie(
        "air_slows_what_falls",
        every_moving_body(drag=lambda b: b.drag and b.drag.model_copy(update={"area_m2": 1.0})),
    ),
    "no springs of hinges": Lie(
        "spring_swings_a_hinge", of_joints("hinge", stiffness=lambda j: 0.0)
    ),
    "no dampers of hinges": Lie("spring_swings_a_hinge", of_joints("hinge", damping=lambda j: 0.0)),
    "dampers of hinges halved": Lie(
        "spring_swings_a_hinge", of_joints("hinge", damping=lambda j: j.damping / 2)
    ),
    "rest of hinges dropped": Lie("spring_swings_a_hinge", of_joints("hinge", rest=lambda j: 0.0)),
    "no springs of sliders": Lie(
        "spring_swings_a_slider", of_joints("slider", stiffness=lambda j: 0.0)
    ),
    "no dampers of sliders": Lie(
        "spring_swings_a_slider", of_joints("slider", damping=lambda j: 0.0)
    ),
    "rest of sliders dropped": Lie(
        "spring_swings_a_slider", of_joints("slider", rest=lambda j: 0.0)
    ),
    "no armature": Lie("armature_resists_a_motor", every("joints", armature=lambda j: 0.0)),
    "no friction of sliders": Lie(
        "friction_stops_a_slider", of_joints("slider", friction=lambda j: 0.0)
    ),
    "anchors mirrored": Lie(
        "hinge_turns_about_its_anchor",
        of_joints("hinge", anchor_m=lambda j: tuple(-v for v in j.anchor_m)),
    ),
    "anchors in the world's frame": Lie(
        "hinge_turns_about_its_anchor", anchors_in_the_worlds_frame
    ),
}  # fmt: skip

SHAPES = {
    "edges of boxes halved": Lie("boxes_rest_on_their_sides", of_shapes("box", size_m=scaled(0.5))),
    "edges of boxes doubled": Lie(
        "boxes_rest_on_their_sides", of_shapes("box", size_m=scaled(2.0))
    ),
    "edges along x and y swapped": Lie(
        "boxes_rest_on_their_sides",
        of_shapes("box", size_m=lambda s: (s.size_m[1], s.size_m[0], s.size_m[2])),
    ),
    "edge along y for that along x": Lie(
        "boxes_rest_on_their_sides",
        of_shapes("box", size_m=lambda s: (s.size_m[1], s.size_m[1], s.size_m[2])),
    ),
    "edge along x for that along y": Lie(
        "boxes_rest_edgewise",
        of_shapes("box", size_m=lambda s: (s.size_m[0], s.size_m[0], s.size_m[2])),
        spatial=True,
    ),
    "cylinders of half their length": Lie(
        "cylinders_stand_and_lie",
        of_shapes("cylinder", length_m=lambda s: s.length_m / 2),
        spatial=True,
    ),
    "diameter of cylinders for their radius": Lie(
        "cylinders_stand_and_lie",
        of_shapes("cylinder", radius_m=lambda s: 2 * s.radius_m),
        spatial=True,
    ),
    "capsules of half their length": Lie(
        "capsules_stand_and_lie",
        of_shapes("capsule", length_m=lambda s: s.length_m / 2),
        spatial=True,
    ),
    "capsules' length with their caps": Lie(
        "capsules_stand_and_lie",
        of_shapes("capsule", length_m=lambda s: s.length_m - 2 * s.radius_m),
        spatial=True,
    ),
    "diameter of capsules for their radius": Lie(
        "capsules_stand_and_lie",
        of_shapes("capsule", radius_m=lambda s: 2 * s.radius_m),
        spatial=True,
    ),
    "shapes at their body's origin": Lie(
        "shapes_are_where_their_body_has_them", of_shapes(None, position_m=lambda s: ORIGIN)
    ),
    "shapes turned as their body": Lie(
        "shapes_are_where_their_body_has_them", of_shapes(None, orientation_wxyz=lambda s: UPRIGHT)
    ),
    "position of planes ignored": Lie(
        "block_slides_down_a_plane", of_shapes("plane", position_m=lambda s: ORIGIN)
    ),
    "normal of planes ignored": Lie(
        "block_slides_down_a_plane", of_shapes("plane", normal=lambda s: (0.0, 0.0, 1.0))
    ),
    "normal of planes not made a direction": Lie(
        "block_slides_down_a_plane", of_shapes("plane", position_m=far_along)
    ),
    "planes do not turn with their body": Lie(
        "block_slides_down_a_plane", planes_in_the_worlds_frame
    ),
    "normal of planes flipped along x": Lie(
        "block_slides_down_a_plane", of_shapes("plane", normal=flipped(0))
    ),
    "normal of planes flipped along y": Lie(
        "block_slides_down_a_hillside", of_shapes("plane", normal=flipped(1)), spatial=True
    ),
}  # fmt: skip
