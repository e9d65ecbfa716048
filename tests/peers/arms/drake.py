"""The closed loop with Drake."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import (
    BasicVector,
    Context,
    ContinuousState,
    DiagramBuilder,
    DiscreteValues,
    LeafSystem,
)

from tests.peers.controller import Answer, Controller
from tests.peers.numpy_loop import lost, plain
from tests.peers.problem import SAMPLE, Array, MassAndBias, Problem, Run, Trace, Variant

ACCURACY = 1e-4
"""Of Drake's integrator with error control (Drake's own default)."""


def _plant(problem: Problem, period: float) -> MultibodyPlant:
    plant = MultibodyPlant(period)
    Parser(plant).AddModels(problem.urdf)
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"))
    plant.Finalize()
    return plant


def mass_and_bias(problem: Problem) -> MassAndBias:
    """Return M and h by CalcMassMatrix, CalcBiasTerm and gravity."""
    plant = _plant(problem, 0.0)
    context = plant.CreateDefaultContext()

    def evaluate(q: Array, v: Array) -> tuple[Array, Array]:
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
        return plant.CalcMassMatrix(context), bias

    return evaluate


def _plain(problem: Problem, steps: int) -> Run:
    return plain(problem, steps, mass_and_bias(problem))


class _Continuous(LeafSystem):
    """RBFNN-NFTSM as a block in continuous time: the weights are its state."""

    def __init__(self, problem: Problem) -> None:
        super().__init__()
        self.controller, self.problem = Controller(problem), problem
        self.arm = self.DeclareVectorInputPort("state", 12)
        self.DeclareContinuousState(len(problem.centers) * 6)
        self.DeclareVectorOutputPort("torque", 6, self._torque)

    def _answer(self, context: Context) -> Answer:
        state = self.arm.Eval(context)
        W = context.get_continuous_state_vector().CopyToVector().reshape(-1, 6)
        return self.controller(context.get_time(), state[:6], state[6:], W)

    def _torque(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(self._answer(context).torque - self.problem.external)

    def DoCalcTimeDerivatives(self, context: Context, derivatives: ContinuousState) -> None:
        """Let the network learn (Eq. 21)."""
        answer = self._answer(context)
        rates = answer.hidden * (self.problem.learning_rate * answer.S)
        derivatives.get_mutable_vector().SetFromVector(rates.ravel())


class _Sampled(LeafSystem):
    """RBFNN-NFTSM as a block that holds its torque: the torque and the weights are its state."""

    def __init__(self, problem: Problem) -> None:
        super().__init__()
        self.controller, self.problem = Controller(problem), problem
        self.arm = self.DeclareVectorInputPort("state", 12)
        self.DeclareDiscreteState((len(problem.centers) + 1) * 6)
        self.DeclarePeriodicDiscreteUpdateEvent(problem.h, 0.0, self._sample)
        self.DeclareVectorOutputPort("torque", 6, self._torque, {self.xd_ticket()})

    def _sample(self, context: Context, values: DiscreteValues) -> None:
        state = self.arm.Eval(context)
        W = context.get_discrete_state_vector().value()[6:].reshape(-1, 6)
        answer = self.controller(context.get_time(), state[:6], state[6:], W)
        W = W + answer.hidden * (self.problem.h * self.problem.learning_rate * answer.S)
        torque = answer.torque - self.problem.external
        values.set_value(np.concatenate([torque, W.ravel()]))

    def _torque(self, context: Context, output: BasicVector) -> None:
        output.SetFromVector(context.get_discrete_state_vector().value()[:6])


def _diagram(
    problem: Problem, block: LeafSystem, period: float, config: SimulatorConfig
) -> tuple[Simulator, MultibodyPlant, Context]:
    builder = DiagramBuilder()
    plant = builder.AddSystem(_plant(problem, period))
    builder.AddSystem(block)
    builder.Connect(plant.get_state_output_port(), block.get_input_port())
    builder.Connect(block.get_output_port(), plant.get_applied_generalized_force_input_port())
    simulator = Simulator(builder.Build())
    ApplySimulatorConfig(config, simulator)
    context = plant.GetMyContextFromRoot(simulator.get_mutable_context())
    plant.SetVelocities(context, problem.v0)
    simulator.Initialize()
    return simulator, plant, context


def _advance(
    problem: Problem, steps: int, stride: int, parts: tuple[Simulator, MultibodyPlant, Context]
) -> Trace:
    simulator, plant, context = parts
    rows = [plant.GetPositions(context).copy()]
    for n in range(stride, steps + 1, stride):
        t = n * problem.h
        try:
            simulator.AdvanceTo(t)
        except RuntimeError:
            return Trace(np.array(rows), t)
        if lost(plant.GetVelocities(context)):
            return Trace(np.array(rows), t)
        if n % SAMPLE == 0:
            rows.append(plant.GetPositions(context).copy())
    return Trace(np.array(rows))


def _implicit_integrator(problem: Problem, steps: int) -> Run:
    """Let Drake's own stiff integrator with error control solve the loop in continuous time."""
    config = SimulatorConfig(
        integration_scheme="radau3", max_step_size=SAMPLE * problem.h, accuracy=ACCURACY
    )
    parts = _diagram(problem, _Continuous(problem), 0.0, config)
    return lambda: _advance(problem, steps, SAMPLE, parts)


def _held_torque(problem: Problem, steps: int) -> Run:
    """Step a discrete plant under a torque held for a period."""
    parts = _diagram(problem, _Sampled(problem), problem.h, SimulatorConfig())
    return lambda: _advance(problem, steps, 1, parts)


VARIANTS = (
    Variant("NumPy on `CalcMassMatrix`, `CalcBiasTerm`", "plain", _plain),
    Variant("`Simulator`, radau3 with error control", "own", _implicit_integrator),
    Variant("`Simulator`, discrete plant", "held", _held_torque),
)
VERSION = f"Drake {version('drake')}"
