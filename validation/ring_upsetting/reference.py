"""Makes reference.csv: the inner radius of an upset ring by rigid-plastic finite elements.

    python reference.py            (numpy, scipy; minutes)

Flow formulation: the velocity makes the power
    J = int Y eps_dot dV + int m Y / sqrt(3) |u_r| dA + K/2 int (div u)^2 dV
least. Axisymmetric quadrilaterals of four nodes, 2 x 2 points of integration, one for the volume (K = 1e4 Y s). The
half ring of height 1, radii 1.5 and 3, under a plate of speed 1; 80 steps of 0.5 % of the height, nodes of the free
sides that reach the plate stay on it. Both |.| are rounded below 0.002. Read off as in the runs:
mean height 2 <z>, mean inner radius from <r^2> (crates/verification/src/observable/upset_ring.rs). Without friction
the ring keeps its proportions: R_i = R_i0 (1 - reduction)^(-1/2).
"""

import sys
from pathlib import Path

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve

INNER, OUTER, HEIGHT = 1.5, 3.0, 1.0
STEPS, MOST = 80, 0.42
REDUCTIONS = (0.2, 0.3, 0.4)
SMALL, BULK = 2e-3, 1e4
METRIC = np.array([1.0, 1.0, 1.0, 0.5]) * 2 / 3  # eps_dot^2 = 2/3 (rr, zz, tt) + 1/3 gamma^2
POINT = 1 / np.sqrt(3)
POINTS = [(-POINT, -POINT), (POINT, -POINT), (POINT, POINT), (-POINT, POINT)]


def shape(xi, eta):
    return 0.25 * np.array([(1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta)])


def strain(corners, xi, eta):
    """Matrices from velocities to (rr, zz, tt, gamma), and radius times area per point."""
    slope = 0.25 * np.array(
        [[-(1 - eta), 1 - eta, 1 + eta, -(1 + eta)], [-(1 - xi), -(1 + xi), 1 + xi, 1 - xi]]
    )
    jacobian = np.einsum("ak,ekb->eab", slope, corners)
    gradient = np.linalg.solve(jacobian, np.broadcast_to(slope, (len(corners), 2, 4)))
    radius = corners[:, :, 0] @ shape(xi, eta)
    matrix = np.zeros((len(corners), 4, 8))
    matrix[:, 0, 0::2] = gradient[:, 0]
    matrix[:, 1, 1::2] = gradient[:, 1]
    matrix[:, 2, 0::2] = shape(xi, eta) / radius[:, None]
    matrix[:, 3, 0::2] = gradient[:, 1]
    matrix[:, 3, 1::2] = gradient[:, 0]
    return matrix, np.linalg.det(jacobian) * radius


def velocity(places, elements, held, friction, start):
    """Least power by successive substitution."""
    plate, middle = held
    freedom = np.stack([2 * elements, 2 * elements + 1], -1).reshape(len(elements), 8)
    rows, columns = np.repeat(freedom, 8, 1).ravel(), np.tile(freedom, (1, 8)).ravel()
    size = 2 * len(places)
    corners = places[elements]
    points = [strain(corners, *point) for point in POINTS]
    centre, weight = strain(corners, 0, 0)
    volume = centre[:, :3].sum(1)
    rigid = BULK * np.einsum("e,ei,ej->eij", 4 * weight, volume, volume)
    touching = np.where(plate)[0]
    touching = touching[np.argsort(places[touching, 0])]
    fixed, value = np.zeros(size, bool), np.zeros(size)
    fixed[2 * np.where(middle)[0] + 1] = True
    fixed[2 * touching + 1] = True
    value[2 * touching + 1] = -1.0
    free, speed = ~fixed, start
    for turn in range(200):
        local = rigid.copy()
        for matrix, area in points:
            rate = np.einsum("eij,ej->ei", matrix, speed[freedom])
            rate = np.maximum(np.sqrt((rate * rate) @ METRIC), SMALL)
            local += np.einsum("e,eki,k,ekj->eij", area / rate, matrix, METRIC, matrix)
        drag = np.zeros(size)
        for a, b in zip(touching[:-1], touching[1:]):
            near, far = places[a, 0], places[b, 0]
            for node, share in ((a, 2 * near + far), (b, near + 2 * far)):
                slip = np.hypot(speed[2 * node], SMALL)
                drag[2 * node] += friction / np.sqrt(3) * share * (far - near) / 6 / slip
        matrix = sparse.coo_matrix((local.ravel(), (rows, columns)), shape=(size, size)).tocsc()
        matrix = matrix + sparse.diags(drag)
        new = value.copy()
        new[free] = spsolve(matrix[free][:, free].tocsc(), -(matrix @ value)[free])
        change = np.abs(new - speed).max()
        speed = new if turn < 4 else 0.5 * (speed + new)
        if change < SMALL:
            break
    return speed


def course(friction, across, along):
    """Reductions of the mean height and changes of the mean inner radius."""
    r, z = np.meshgrid(np.linspace(INNER, OUTER, across + 1), np.linspace(0, HEIGHT, along + 1), indexing="ij")
    places = np.c_[r.ravel(), z.ravel()]
    grid = np.arange(len(places)).reshape(across + 1, along + 1)
    elements = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], -1).reshape(-1, 4)
    plate, middle = np.zeros(len(places), bool), np.zeros(len(places), bool)
    plate[grid[:, -1]], middle[grid[:, 0]] = True, True
    speed = np.zeros(2 * len(places))
    speed[0::2], speed[1::2] = 0.5 * places[:, 0], -places[:, 1] / HEIGHT
    height, found = HEIGHT, [(0.0, 0.0)]
    for _ in range(STEPS):
        speed = velocity(places, elements, (plate, middle), friction, speed)
        places = places + HEIGHT * MOST / STEPS * speed.reshape(-1, 2)
        height -= HEIGHT * MOST / STEPS
        over = (places[:, 1] > height - 1e-6) & ~plate
        plate |= over
        places[over, 1] = height
        corners, total, square, level = places[elements], 0.0, 0.0, 0.0
        for point in POINTS:
            _, area = strain(corners, *point)
            radius, up = corners[:, :, 0] @ shape(*point), corners[:, :, 1] @ shape(*point)
            total += area.sum()
            square += (area * radius**2).sum()
            level += (area * up).sum()
        mean = 2 * level / total
        inner = np.sqrt(square / total - 0.5 * (OUTER**2 - INNER**2) * HEIGHT / mean)
        found.append((1 - mean / HEIGHT, inner / INNER - 1))
    return np.array(found)


if __name__ == "__main__":
    mesh = (int(sys.argv[1]), int(sys.argv[2])) if len(sys.argv) > 2 else (36, 24)
    lines = ["run,change_at_0.2,change_at_0.3,change_at_0.4"]
    for friction in (0, 0.1, 0.5):
        if friction:
            found = course(friction, *mesh)
            values = [np.interp(reduction, found[:, 0], found[:, 1]) for reduction in REDUCTIONS]
        else:
            values = [(1 - reduction) ** -0.5 - 1 for reduction in REDUCTIONS]
        text = ",".join(f"{value:.4f}" for value in values)
        lines += [f"m_{friction}_{grade},{text}" for grade in ("coarse", "fine")]
        print(lines[-1], flush=True)
    (Path(__file__).parent / "reference.csv").write_text("\n".join(lines) + "\n")
