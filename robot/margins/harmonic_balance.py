r"""Where chattering comes from: the limit cycle of each joint by harmonic balance.

A switching function that is fed with :math:`S = A \sin\omega t` answers, but for its harmonics,
with :math:`N(A)\,S`, its describing function. The loop swings where that comes back as it went out
(Gelb and Vander Velde, *Multiple-Input Describing Functions*, 1968; Utkin, Guldner and Shi,
*Sliding Mode Control in Electro-Mechanical Systems*, 2009):

.. math:: H(j\omega)\,N(A) = -1

Joints act on each other through the inertia matrix. Those whose own frequencies are close lock to
one, and their switching adds up: joints 2 and 3 of this arm then swing against each other, 1.5 to 2
times as far as either alone. So the balance is that of all joints that lock,

.. math:: a_i = -\sum_j H_{ij}(j\omega)\,N_j(|a_j|)\,a_j

and joints apart in frequency keep their own. Amplitudes are those of the whole wave, with the
harmonics that the loop passes: a triangle is 1.23 times as high as its fundamental.

Super-twisting turns a swing by an angle that depends on how far and how fast it goes, so that its
amplitude decides its frequency as well (Boiko, *Discontinuous Control Systems*, 2009).

It knows neither torque limits nor Coulomb friction, nor that a sampled switch falls between two
samples: where a period is few samples long, it is one of those between ``slowest`` and ``fastest``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from slidetune.robot.margins.switching_loop import SwitchingLoop
from slidetune.robot.margins.switching_term import SwitchingTerm, integrator

Array = np.ndarray

LOWEST = 5.0
"""Frequency in [rad/s] below which no limit cycle is looked for (*ours*)."""
_SCAN = 160
"""Frequencies at which a curve is looked at for a crossing (*ours*)."""
_ROUNDS = 200
"""Rounds in which amplitudes and phases of locked joints settle (*ours*)."""
_SILENT = 1e-3
"""Share of the layer below which an amplitude counts as none (*ours*)."""
_HARMONICS = np.arange(1, 24, 2)
"""Odd harmonics of which a wave is put together (*ours*)."""
_FINEST = 128
"""Points of a period at most, and without sampling (*ours*)."""


@dataclass(frozen=True)
class LimitCycle:
    """How one joint's sliding variable swings, by harmonic balance.

    Attributes:
        omega: its frequency in [rad/s].
        slowest: the frequency if every switch came as late as sampling can make it, in [rad/s].
        fastest: the same if every switch came at once.
        amplitude: half of what S swings in [rad/s], 0 where the layer silences it.
        alone: the same if no other joint switched.
        crossing: how far from 0 its curve is where it balances; of a switching function the width
            of the boundary layer in [rad/s] from which on it is silent.
        locked: the joints that swing with it, itself among them, from 0.
        phasors: how all six switch against this one; 0 where one is not locked. Shape (6,).
    """

    omega: float
    slowest: float
    fastest: float
    amplitude: float
    alone: float
    crossing: float
    locked: tuple[int, ...]
    phasors: Array

    def curve(self, loop: SwitchingLoop, joint: int, omega: Array) -> Array:
        """Return what a swing of this joint's sw does to the samples of its -S in [rad/s].

        The joints that are locked to it swing along.

        Args:
            loop: the loop whose limit cycle it is.
            joint: which joint this is, from 0.
            omega: frequencies in [rad/s]. Shape (n,).
        """
        return np.asarray(loop.folded(omega) * (loop.response(omega)[:, joint] @ self.phasors))


def swing_frequencies(loop: SwitchingLoop, term: SwitchingTerm) -> Array:
    """Return where each joint alone would swing in [rad/s], NaN for nowhere. Shape (6,).

    Where one of them does there is a limit cycle, and this takes a tenth of its time.

    Args:
        loop: the loop around the switching terms.
        term: these of all joints.
    """
    return _own_frequencies(loop, term, 0.0)


def limit_cycles(
    loop: SwitchingLoop, term: SwitchingTerm, *, how_far: bool = True
) -> tuple[LimitCycle | None, ...]:
    """Return the limit cycle of each joint; ``None`` where the balance has no solution.

    Args:
        loop: the loop around the switching terms.
        term: these of all joints.
        how_far: whether the amplitudes are wanted, which take most of the time; NaN if not.
    """
    own, late, early = (_own_frequencies(loop, term, part * loop.hold) for part in (0.0, 0.5, -0.5))
    found: list[LimitCycle | None] = [None] * len(own)
    for joints in _groups(loop, own):
        group = _Locked(loop, joints, term.of(joints))
        omega, phasors = group.frequency(own[joints])
        folded = float(loop.folded(np.array([omega]))[0])
        crossings = folded * np.abs(group.answer(omega, phasors) / phasors)
        amplitudes = group.amplitudes(omega, phasors) if how_far else np.full(len(joints), np.nan)
        if group.term.has_layer and np.all(crossings < group.term.layer):
            amplitudes = np.zeros(len(joints))  # close to the layer it dies out slowly
        for place, joint in enumerate(joints):
            alone = amplitudes[place]
            if len(joints) > 1 and how_far:
                one = _Locked(loop, [joint], term.of([joint]))
                alone = one.amplitudes(omega, np.ones(1, complex))[0]
            among = np.zeros(len(own), complex)
            among[joints] = phasors / phasors[place]
            found[joint] = LimitCycle(
                omega=omega,
                slowest=omega * float(late[joint] / own[joint]),
                fastest=min(omega * float(early[joint] / own[joint]), loop.fastest),
                amplitude=float(amplitudes[place]),
                alone=float(alone),
                crossing=float(crossings[place]),
                locked=tuple(joints),
                phasors=among,
            )
    return tuple(found)


def _own_frequencies(loop: SwitchingLoop, term: SwitchingTerm, late: float) -> Array:
    """Return where each joint alone would swing in [rad/s], NaN for nowhere. Shape (6,).

    Sampling turns a curve by 90 degrees at half of the control rate: a sampled loop that has not
    fallen past -180 degrees before swings there.
    """
    omegas = np.geomspace(LOWEST, loop.fastest, _SCAN)
    response = loop.response(omegas, late, k1=0.0)
    found = np.full(response.shape[2], np.nan)
    for joint in range(len(found)):
        curve = response[:, joint, joint]
        if term.acts(joint) and np.any(np.abs(curve) > 0.0):
            if term.twisting:
                # As it stands before the real axis once the term has turned it.
                size = np.abs(curve)
                amplitude = term.balanced_amplitude(joint, size, omegas, loop.hold)
                passed = term.of([joint]).describing_function(amplitude, omegas, loop.hold)
                curve = curve * passed / np.abs(passed)
            omega = _swings_at(omegas, curve)
            sampled = loop.hold and not (term.twisting and curve[0].imag >= 0.0)
            found[joint] = loop.fastest if omega is None and sampled else omega or np.nan
    return found


def _swings_at(omegas: Array, curve: Array) -> float | None:
    """Return the frequency of the first limit cycle that a growing swing meets, in [rad/s].

    As a swing grows, -1/N(A) moves left along the real axis. The swing stops growing where the
    curve falls past -180 degrees and surrounds nothing to the left (Nyquist).
    """
    low, high = curve.imag[:-1], curve.imag[1:]
    share = np.divide(low, low - high, out=np.zeros_like(low), where=low != high)
    real = curve.real[:-1] + share * np.diff(curve.real)
    places = np.flatnonzero(((low < 0.0) != (high < 0.0)) & (real < 0.0))
    falls = np.where(low[places] < 0.0, 1, -1)
    # Integrators have turned it past -180 degrees before the first frequency, infinitely far left.
    before = int(curve[0].imag >= 0.0 and curve[0].real < 0.0)
    for place in places[np.argsort(-real[places])]:
        beyond = before + falls[real[places] < real[place]].sum()
        if low[place] < 0.0 and beyond <= 0:
            return float(omegas[place] * (omegas[place + 1] / omegas[place]) ** share[place])
    return None


def _groups(loop: SwitchingLoop, own: Array) -> list[list[int]]:
    """Return the joints that swing, those together that lock to one frequency.

    Two lock where their own frequencies differ by a smaller share than that with which one moves
    the other (Adler 1946, for a phase that turns by about a radian over its frequency).
    """
    group_of = {int(joint): {int(joint)} for joint in np.flatnonzero(np.isfinite(own))}
    for one in group_of:
        for other in [joint for joint in group_of if joint > one]:
            omega = float(np.sqrt(own[one] * own[other]))
            H = np.abs(loop.response(np.array([omega]))[0])
            pull = max(H[one, other] / H[one, one], H[other, one] / H[other, other])
            if abs(own[one] - own[other]) < pull * omega:
                joined = group_of[one] | group_of[other]
                group_of.update(dict.fromkeys(joined, joined))
    return [sorted(group) for joint, group in group_of.items() if joint == min(group)]


@dataclass(frozen=True)
class _Locked:
    """Joints that swing at one frequency; all arrays below have one value a joint, shape (n,)."""

    loop: SwitchingLoop
    joints: list[int]
    term: SwitchingTerm

    def _response(self, omega: Array) -> Array:
        return self.loop.response(omega)[:, self.joints][:, :, self.joints]

    def answer(self, omega: float, swing: Array) -> Array:
        """Return how each S swings when the switching functions do."""
        return np.asarray(-self._response(np.array([omega]))[0] @ swing)

    def _lead(self, omega: float, swing: Array) -> tuple[Array, float]:
        """Return phasors in which the joints hold each other, and by how much S then leads sw."""
        H, lead = self._response(np.array([omega]))[0], 0.0
        for _ in range(_ROUNDS):
            answer = -H @ swing
            passed = answer / np.maximum(np.abs(answer), 1e-300)
            if self.term.twisting:
                sizes = np.maximum(np.abs(answer), 1e-300)
                passed = answer * self.term.describing_function(sizes, omega, self.loop.hold)
            lead = float(np.angle(np.vdot(swing, passed)))
            before, swing = swing, passed * np.exp(-1j * lead)
            if np.abs(before - swing).max() < 1e-9 * np.abs(swing).max():
                break
        return swing, lead

    def frequency(self, own: Array) -> tuple[float, Array]:
        """Return the common frequency in [rad/s] and phasors of the switching functions.

        Args:
            own: frequencies at which each would swing alone in [rad/s].
        """
        if len(own) == 1:
            return float(own[0]), np.ones(1, complex)
        # The mode that the layer would be the last to silence is the one that wins.
        values, vectors = np.linalg.eig(self._response(np.array([own.mean()]))[0])
        mode = vectors[:, np.argmax(np.abs(values))]
        start = np.exp(1j * np.angle(mode / mode[np.argmax(np.abs(mode))]))
        low, high = 0.7 * float(own.min()), min(1.4 * float(own.max()), self.loop.fastest)
        swing, lead = self._lead(high, start)
        if lead > 0.0:
            return high, swing
        while high / low > 1.0 + 1e-5:
            middle = float(np.sqrt(low * high))
            ahead = self._lead(middle, start)[1] > 0.0
            low, high = (middle, high) if ahead else (low, middle)
        return low, self._lead(low, start)[0]

    def amplitudes(self, omega: float, phasors: Array) -> Array:
        """Return half of what each S swings in [rad/s].

        The wave is put together of the harmonics that come back through the loop, of a torque that
        is held from sample to sample, until it is the one that makes this torque.
        """
        count = self._samples(omega)
        angles = (np.arange(count) + 0.5) * 2.0 * np.pi / count
        turn = np.exp(1j * _HARMONICS[:, None] * angles)
        # The hold's delay is in the loop already; what is left is a step about each sample.
        held = np.sinc(_HARMONICS / count) * 2.0 / count
        H = self._response(omega * _HARMONICS)
        share = self._share()
        S = (self.answer(omega, 4.0 / np.pi * phasors * share)[:, None] * turn[0]).imag
        for _ in range(_ROUNDS):
            torque = share[:, None] * self.term.switched(S)
            if self.term.twisting:
                parts = torque @ turn.conj().T
                signs = self.term.rate[:, None] * np.sign(S)
                parts = (parts + (signs @ turn.conj().T) * self._integrators(omega, count)) * held
            else:
                parts = (torque @ turn.conj().T) * held
            answers = -np.einsum("kij,jk->ik", H, parts)
            lead = np.angle(np.vdot(parts[:, 0], answers[:, 0]))
            before, S = S, (answers * np.exp(-1j * lead * _HARMONICS) @ turn).real
            if np.abs(before - S).max() < 1e-6 * np.abs(S).max():
                break
        silent = _SILENT * self.term.layer[:, None]
        if self.term.has_layer and np.all(np.abs(S) < silent):
            return np.zeros(len(S))
        return np.asarray(0.5 * np.ptp(S, axis=1))

    def _share(self) -> Array:
        """Return what is left of a swing beside the load that the term also has to carry.

        Sign that carries b = sin(pi load / 2) A passes on less of it; an integral carries it all.
        """
        if self.term.twisting:
            return np.ones(len(self.joints))
        load = np.clip(self.loop.load[self.joints], -1.0, 1.0)
        return np.asarray(np.cos(0.5 * np.pi * load))

    def _integrators(self, omega: float, count: int) -> Array:
        """Return what the integral does to each harmonic of a period of so many samples."""
        if self.loop.hold and count < _FINEST:
            omega = 2.0 * np.pi / (count * self.loop.hold)
        return integrator(omega * _HARMONICS, self.loop.hold)

    def _samples(self, omega: float) -> int:
        """Return how many samples make a period: as many above the surface as below."""
        if not self.loop.hold:
            return _FINEST
        pairs = max(1, round(np.pi / (omega * self.loop.hold)))
        return min(2 * pairs, _FINEST)
