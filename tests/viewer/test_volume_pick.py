"""The point of a volume that is seen through a pixel, against volumes where it is known."""

import numpy as np
import pytest
from volume_shapes import DIRECTIONS, EDGE, SOLID, blobs

from meshdepict.color.transfer import TransferFunction
from meshdepict.shapes.volume import Volume
from meshdepict.viewer.windows.volume_pick import first_seen

pytest.importorskip("pyvista")


def scene(volume, points):
    """World positions in the volume's diagonals about its centre."""
    return volume.recentred(np.asarray(points, float))


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("side", [-1, 1])
def test_a_ray_through_a_ball_sees_its_surface(direction, side):
    volume = blobs(direction)
    # The first ball: at voxel (8, 12.5, 50/7), 2.6 wide around; rays along the grid's x axis.
    centre = volume.to_world((8, 12.5, 5 / 0.7))
    along = volume.direction[:, 0] * side
    near, far = scene(volume, [centre - 50 * along, centre + 50 * along])
    found = first_seen(volume, SOLID, near, far)
    away = (found - scene(volume, [centre])[0]) * volume.diagonal
    # Half a voxel, in which opacity grows from nothing to all.
    assert away @ along == pytest.approx(-2.6, abs=0.25)
    np.testing.assert_allclose(away - (away @ along) * along, 0, atol=1e-9)


def test_what_is_cut_off_is_not_seen():
    from vtkmodules.vtkCommonDataModel import vtkPlane

    volume = blobs()
    centre = volume.to_world((8, 12.5, 5 / 0.7))
    x = np.array((50, 0, 0))
    near, far = scene(volume, [centre - x, centre + x])
    plane = vtkPlane()
    plane.SetOrigin(*scene(volume, [centre])[0])
    plane.SetNormal(1, 0, 0)
    found = first_seen(volume, SOLID, near, far, [plane])
    assert (found - scene(volume, [centre])[0])[0] * volume.diagonal == pytest.approx(0, abs=0.2)
    plane.SetOrigin(*far)
    assert first_seen(volume, SOLID, near, far, [plane]) is None


def test_through_haze_it_is_where_half_of_the_light_is_used_up():
    haze = TransferFunction([(0, 0.1, "#ffffff"), (1, 0.1, "#ffffff")], unit="raw")
    volume = Volume(np.linspace(0, 1, 40**3).reshape(40, 40, 40), spacing=(2.0, 1.0, 1.0))
    near, far = scene(volume, [(-100, 20, 20), (200, 20, 20)])
    found = first_seen(volume, haze, near, far) * volume.diagonal + volume.centre
    # A voxel's way is the smallest spacing, 1: (1 − 0.1)^x = 1/2.
    assert found[0] == pytest.approx(np.log(0.5) / np.log(0.9), abs=0.51)


def test_rays_beside_the_volume_and_through_nothing_see_nothing():
    volume = blobs()
    outside = scene(volume, [(-1000, 500, 0), (1000, 500, 0)])
    assert first_seen(volume, SOLID, *outside) is None
    empty = Volume(np.linspace(0, EDGE - 2, 120).reshape(4, 5, 6))
    assert first_seen(empty, SOLID, *scene(empty, [(-10, 2, 2), (10, 2, 2)])) is None
