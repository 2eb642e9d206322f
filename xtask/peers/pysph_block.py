"""The block of `cargo xtask bench --peers` in PySPH: elastic, perfectly plastic, shaken along its length.

usage: pysph_block.py --nx 200 --ny 200 --max-steps 60
Prints `RESULT particles steps processor_seconds` for the steps after the first 10: building and compiling the
equations do not count. Cubic spline with 2h = 2.6 dx (20 neighbours), predictor-corrector with two evaluations
of the forces per step, as PySPH recommends for solids; double precision.
"""

import time

import numpy as np
from pysph.base.kernels import CubicSpline
from pysph.solver.application import Application
from pysph.solver.solver import Solver
from pysph.sph.basic_equations import (
    ContinuityEquation,
    MonaghanArtificialViscosity,
    VelocityGradient2D,
    XSPHCorrection,
)
from pysph.sph.equation import Group
from pysph.sph.integrator import EPECIntegrator
from pysph.sph.integrator_step import SolidMechStep
from pysph.sph.solid_mech.basic import (
    HookesDeviatoricStressRate,
    IsothermalEOS,
    MomentumEquationWithStress,
    MonaghanArtificialStress,
    get_particle_array_elastic_dynamics,
)
from pysph.sph.solid_mech.hvi import VonMisesPlasticity2D

SPACING = 5e-5
DENSITY = 2700.0
WARM_UP = 10


class Block(Application):
    def add_user_options(self, group):
        group.add_argument("--nx", type=int, default=200)
        group.add_argument("--ny", type=int, default=200)

    def create_particles(self):
        across, up = self.options.nx, self.options.ny
        x, y = np.meshgrid((np.arange(across) + 0.5) * SPACING, (np.arange(up) + 0.5) * SPACING)
        h = 1.3 * SPACING
        block = get_particle_array_elastic_dynamics(
            name="block",
            x=x.ravel(),
            y=y.ravel(),
            m=DENSITY * SPACING**2,
            h=h,
            rho=DENSITY,
            constants={
                "wdeltap": CubicSpline(dim=2).kernel(rij=SPACING, h=h),
                "n": 4,
                "rho_ref": DENSITY,
                "E": 70e9,
                "nu": 0.3,
            },
        )
        block.rho0[:] = DENSITY
        block.u[:] = 100.0 * np.sin(2.0 * np.pi * block.x / (across * SPACING))
        self.particle_count = len(block.x)
        return [block]

    def create_solver(self):
        integrator = EPECIntegrator(block=SolidMechStep())
        return Solver(
            kernel=CubicSpline(dim=2), dim=2, integrator=integrator, dt=2e-9, tf=1.0, pfreq=10**8
        )

    def create_equations(self):
        return [
            Group(
                [
                    IsothermalEOS("block", None),
                    VelocityGradient2D("block", ["block"]),
                    VonMisesPlasticity2D("block", None, flow_stress=324.1e6),
                    MonaghanArtificialStress("block", None, eps=0.3),
                ]
            ),
            Group(
                [
                    ContinuityEquation("block", ["block"]),
                    MomentumEquationWithStress("block", ["block"]),
                    MonaghanArtificialViscosity("block", ["block"], alpha=1.0, beta=1.0),
                    HookesDeviatoricStressRate("block", None),
                    XSPHCorrection("block", ["block"], eps=0.5),
                ]
            ),
        ]

    def post_step(self, solver):
        if solver.count == WARM_UP:
            self.warm = time.process_time()


if __name__ == "__main__":
    block = Block()
    block.run()
    steps = block.solver.count - WARM_UP
    print("RESULT", block.particle_count, steps, time.process_time() - block.warm)
