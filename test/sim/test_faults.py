"""Faults: closed forms, the fast model against the plain equations, ramps, checkpoints, lines where they belong."""

import math
from dataclasses import replace

import numpy as np
import pytest

from nw_gear_common import names
from nw_gear_common.errors import InputError
from nw_gear_sim import config
from nw_gear_sim.drives import FixedPoint
from nw_gear_sim.equilibrium import find_equilibrium
from nw_gear_sim.faults.injection import Injection
from nw_gear_sim.faults.ramps import Ramps
from nw_gear_sim.gearbox import Gearbox
from nw_gear_sim.nodes.session import Session
from nw_gear_sim.params.faults import FaultSettings
from nw_gear_sim.physics.drive import Drive
from nw_gear_sim.physics.tooth import share, share_slope
from nw_gear_sim.reference.faults import peak_phase
from nw_gear_sim.reference.model import Instant, ReferenceModel
from nw_gear_sim.reference.states import random_state
from nw_gear_sim.simulation import Simulation

CONFIGURATION = config.load("rated")
RATED = CONFIGURATION.turbine.rated_speed
DRIVE = Drive(RATED, RATED, 4.3e6, 4.3e6)
FAULTS = {
    "crack of the ring": {"fault_crack": 0.4, "fault_crack_gear": "ring", "fault_crack_tooth": 7},
    "crack of a planet": {"fault_crack": 0.4, "fault_crack_gear": "p1_2", "fault_crack_tooth": 3},
    "crack of the sun": {"fault_crack": 0.4, "fault_crack_gear": "sun", "fault_crack_tooth": 11},
    "crack of the pinion": {"fault_crack": 0.4, "fault_crack_gear": "pinion", "fault_crack_tooth": 0},
    "pitch error of the ring": {"fault_pitch": 3e-5, "fault_pitch_gear": "ring", "fault_pitch_tooth": 60},
    "pitch error of a planet": {"fault_pitch": 3e-5, "fault_pitch_gear": "p2_3", "fault_pitch_tooth": 82},
    "eccentric sun": {"fault_eccentricity": 4e-5, "fault_eccentric_gear": "sun"},
    "eccentric ring": {"fault_eccentricity": 4e-5, "fault_eccentric_gear": "ring"},
    "wear": {"fault_wear": 3e-5, "fault_wear_stiffness": 0.1, "fault_wear_stage": "II"},
    "clearance": {"fault_clearance": 4e-5, "fault_clearance_bearing": "pb2_2"},
    "outer race": {"fault_race_depth": 2e-5, "fault_race_bearing": "sb", "fault_race_width": 0.4},
    "inner race": {"fault_race_depth": 2e-5, "fault_race": "inner", "fault_race_width": 0.3},
}


# --- teeth ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("contact_ratio", [1.2, 1.7, 2.0, 3.35])
def test_the_shares_of_engaged_teeth_add_up_to_one(contact_ratio):
    fade = contact_ratio - 1.0
    for place in np.linspace(0.0, 1.0, 41):
        shares = [share(place + n, fade) for n in range(6)]
        assert sum(shares) == pytest.approx(1.0, abs=1e-12)
        assert min(shares) >= 0.0
    assert share(-1e-9, fade) == 0.0
    assert share(contact_ratio + 1e-9, fade) == 0.0
    p = np.linspace(0.0, contact_ratio, 200)
    slopes = [(share(x + 1e-6, fade) - share(x - 1e-6, fade)) / 2e-6 for x in p]
    assert [share_slope(x, fade) for x in p] == pytest.approx(slopes, abs=1e-5)


def excitation(fault, turns_of_the_ring, points):
    """K and e of all meshes over the ring's angle, less those of a sound gearbox."""
    columns = []
    for faults in (FaultSettings(**fault), FaultSettings()):
        gearbox = Gearbox(CONFIGURATION)
        Injection(gearbox).change(faults, 0.0)
        rows = []
        for angle in np.linspace(0.0, 2 * np.pi * turns_of_the_ring, points, endpoint=False):
            gearbox.set_instant(4.3e6, RATED, float(angle))
            rows.append(gearbox.instants.excitation[0, :, :3].copy())
        columns.append(np.array(rows))
    return columns[0], columns[1]


@pytest.mark.parametrize(
    ("gear", "mesh", "turns"), [("sun", "II_1", 40 / 91 * 22 / 83), ("p1_2", "I_2", 22 / 91), ("ring", "I_3", 1.0)]
)
def test_a_cracked_tooth_is_felt_once_a_turn_in_each_mesh_of_its_gear(gear, mesh, turns):
    faulty, sound = excitation({"fault_crack": 0.5, "fault_crack_gear": gear, "fault_crack_tooth": 4}, turns, 3000)
    lost = 1.0 - faulty[:, :, 0] / sound[:, :, 0]
    k = names.MESHES.index(mesh)
    assert np.count_nonzero(np.diff((lost[:, k] > 1e-12).astype(int)) == 1) + (lost[0, k] > 1e-12) in (1, 2)
    pair = Gearbox(CONFIGURATION).kinematics.stage(mesh).pair
    teeth = pair.driver.teeth if gear == "ring" else pair.driven.teeth
    assert lost[:, k].sum() / 3000 * teeth == pytest.approx(0.5, rel=2e-3)  # the share of a tooth has area 1
    others = [m for m in range(7) if names.MESHES[m][:2] != mesh[:2]]
    assert not lost[:, others].any()


def test_a_tooth_of_the_ring_goes_from_planet_to_planet():
    """It enters each of the three meshes a third of a turn of the ring after the one before."""
    faulty, sound = excitation({"fault_pitch": 1e-5, "fault_pitch_gear": "ring", "fault_pitch_tooth": 20}, 1.0, 2730)
    error = (faulty - sound)[:, :3, 1]
    centre = [np.angle(np.sum(error[:, j] * np.exp(2j * np.pi * np.arange(2730) / 2730))) for j in range(3)]
    steps = np.diff(centre) / (2 * np.pi) % 1.0
    assert steps == pytest.approx(1.0 / 3.0, abs=1e-6)


def test_all_teeth_out_of_pitch_are_a_constant_error():
    gearbox = Gearbox(CONFIGURATION)
    gearbox.set_instant(4.3e6, RATED, 0.3)
    before = gearbox.instants.excitation[0, :, 1:3].copy()
    total = np.zeros((7, 2))
    for tooth in range(20):
        other = Gearbox(CONFIGURATION)
        Injection(other).change(
            FaultSettings(fault_pitch=1e-5, fault_pitch_gear="pinion", fault_pitch_tooth=tooth), 0.0
        )
        other.set_instant(4.3e6, RATED, 0.3)
        total += other.instants.excitation[0, :, 1:3] - before
    assert total[6] == pytest.approx([1e-5, 0.0], abs=1e-12)


def test_an_eccentric_gear_adds_a_wave_once_a_turn():
    faulty, sound = excitation({"fault_eccentricity": 2e-5, "fault_eccentric_gear": "sun"}, 22 / 83 * 40 / 91, 64)
    line = np.fft.rfft((faulty - sound)[:, 3:6, 1], axis=0) / 32
    assert np.abs(line[1]) == pytest.approx(2e-5, rel=1e-9)
    assert np.abs(np.delete(line, 1, axis=0)).max() < 1e-15
    turned = np.diff(np.angle(line[1])) / (2 * np.pi) % 1.0
    assert sorted({round(float(t), 6) for t in turned}) in ([0.333333], [0.666667])


# --- against the plain equations --------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", list(FAULTS))
def test_forces_are_those_of_the_plain_equations(kind):
    faults = FaultSettings(**FAULTS[kind])
    smooth = config.with_values({"friction.enabled": False}, CONFIGURATION)  # friction is tabulated in the fast model
    fast = Gearbox(smooth)
    injection = Injection(fast)
    injection.change(faults, 0.0)
    loaded = 0.0
    if faults.fault_race_depth:
        marks = fast.laws.bearings.marks
        loaded = float(marks.angle[0])
    plain = ReferenceModel(smooth, faults, loaded)
    sound = ReferenceModel(smooth)
    felt = 0
    for seed, angle in enumerate(angles_at_which_it_is_felt(fast)):
        q, v = random_state(plain, seed)
        wanted = plain.accelerations(q, v, Instant(angle, RATED, 4.3e6))
        felt += wanted != sound.accelerations(q, v, Instant(angle, RATED, 4.3e6))
        for name, got in accelerations(fast, q, v, angle).items():
            scale = max(abs(wanted[n]) for n in wanted if n.split(".")[1] == name.split(".")[1])
            assert got == pytest.approx(wanted[name], abs=1e-9 * scale), name
    assert felt >= (1 if faults.fault_race_depth else 2)


def angles_at_which_it_is_felt(gearbox):
    """Some angles of the ring, of which teeth that differ, if there are any, are engaged at most."""
    every = np.linspace(0.0, 2 * np.pi, 2000)
    sound, felt = Gearbox(CONFIGURATION), []
    for angle in every if gearbox.laws.teeth.used[0] else []:
        for one in (gearbox, sound):
            one.set_instant(4.3e6, RATED, float(angle))
        apart = np.abs(gearbox.instants.excitation[0] - sound.instants.excitation[0])
        if apart[:, 0].max() > 1e8 or apart[:, 1].max() > 3e-6:
            felt.append(float(angle))
    return felt[:: max(1, len(felt) // 3)][:3] or [0.2, 1.3, 2.6, 4.0, 5.1, 5.9]


def accelerations(gearbox, q, v, angle):
    """Of the fast model, by the names of the plain one."""
    layout, base = gearbox.layout, gearbox.kinematics.bodies.ring.base_radius
    place = {f"{n}.{a}": getattr(node, a) for n, node in layout.nodes.items() for a in "uxyz" if getattr(node, a) >= 0}
    scale = dict.fromkeys(place, 1.0)
    for motion, column in (("w", "w"), ("v", "v"), ("psi", "p"), ("z", "z")):
        for i in range(layout.segments):
            place[f"ring.{motion}.{i}"] = layout.ring(column).start + i
            scale[f"ring.{motion}.{i}"] = base if motion == "psi" else 1.0
    x, u = np.zeros(layout.size), np.zeros(layout.size)
    for name, k in place.items():
        x[k], u[k] = q[name] * scale[name], v[name] * scale[name]
    gearbox.set_instant(4.3e6, RATED, angle)
    found = gearbox.forces(x, u) / gearbox.mass
    return {name: found[k] / scale[name] for name, k in place.items()}


@pytest.mark.parametrize("integrator", ["gautschi", "etdrk4"])
def test_the_ring_in_modes_feels_faults_as_the_whole_ring_does(integrator):
    """A cracked ring and a race defect, a tenth of a second: close to rk4 beside the size of what they change."""
    faults = FaultSettings(**FAULTS["crack of the ring"], **FAULTS["outer race"])
    courses = {}
    for name, put in (("rk4", faults), (integrator, faults), ("sound", FaultSettings())):
        chosen = config.with_values({"numerics.integrator": "rk4" if name == "sound" else name}, CONFIGURATION)
        simulation = Simulation(chosen, DRIVE)
        simulation.inject(replace(put, fault_crack_tooth=2))
        courses[name] = simulation.advance(512, DRIVE).x
    changed = np.std(courses["rk4"] - courses["sound"], axis=0)
    off = np.std(courses[integrator] - courses["rk4"], axis=0)
    assert changed[:3].max() > 1e-7
    assert np.all(off < 0.25 * np.maximum(changed, 1e-7))


def test_every_other_fault_in_modes_too():
    """Pitch error, eccentricity, wear and clearance of stage III, which the first hundredths of a second feel."""
    faults = FaultSettings(
        fault_pitch=1e-4, fault_pitch_gear="pinion", fault_pitch_tooth=1, fault_eccentricity=2e-4,
        fault_eccentric_gear="pinion", fault_wear=2e-5, fault_wear_stiffness=0.2, fault_wear_stage="III",
        fault_clearance=1e-5, fault_clearance_bearing="b21",
    )  # fmt: skip
    courses = {}
    for name, integrator, put in (
        ("whole", "rk4", faults), ("modes", "gautschi", faults), ("sound", "gautschi", FaultSettings())
    ):  # fmt: skip
        simulation = Simulation(config.with_values({"numerics.integrator": integrator}, CONFIGURATION), DRIVE)
        simulation.inject(put)
        courses[name] = simulation.advance(256, DRIVE).x[128:, 6]  # the jump itself excites what the modes leave out
    changed = np.std(courses["whole"] - courses["sound"])
    assert changed > 1e-6
    assert np.std(courses["modes"] - courses["whole"]) < 0.1 * changed


# --- what they do to the gearbox --------------------------------------------------------------------------------------


def test_a_cracked_tooth_bends_by_the_force_over_what_stiffness_is_left():
    """At rest the torque gives the force of the mesh of stage III; the deflection is that over K (1 - s w)."""
    stage = Gearbox(CONFIGURATION).kinematics.stage("III")
    engaged = stage.pair.contact_ratio + stage.pair.overlap_ratio
    entered = 0.5 * engaged
    start = math.remainder(peak_phase(stage), 2 * math.pi)
    angle, torque, severity = (2 * math.pi * entered - start) / stage.mesh_ratio, 4.3e6, 0.6
    bent = {}
    for s in (0.0, severity):
        gearbox = Gearbox(CONFIGURATION)
        Injection(gearbox).change(FaultSettings(fault_crack=s, fault_crack_gear="pinion"), 0.0)
        q = find_equilibrium(gearbox, torque, angle=angle).q
        gearbox.set_instant(torque, 0.0, angle, static=True)
        gearbox.forces(q, np.zeros_like(q))
        bent[s] = gearbox.contact.x[6] - gearbox.laws.mesh.backlash[6], gearbox.contact.elastic[6]
    carried = share(entered, engaged - 1)
    assert 0.2 < carried < 1.0
    assert bent[severity][1] == pytest.approx(bent[0.0][1], rel=1e-6)
    assert bent[severity][0] == pytest.approx(bent[0.0][0] / (1 - severity * carried), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("race", "factor"), [("outer", "cage"), ("inner", "shaft less cage")])
def test_rollers_pass_a_defect_at_the_known_rate(race, factor):
    """Lines of the bearing's force where Z times the rate of the cage against the race says (b21, 16.2 Hz shaft)."""
    kinematics = Gearbox(CONFIGURATION).kinematics
    cage, shaft = kinematics.cage_ratio["b21"], kinematics.shaft_ratio["output"]
    rollers = CONFIGURATION.bearings.b21.rollers
    order = rollers * (cage if factor == "cage" else shaft - cage)
    forces = []
    for depth in (0.0, 2e-5):
        simulation = Simulation(CONFIGURATION, DRIVE)
        simulation.inject(FaultSettings(fault_race_depth=depth, fault_race=race, fault_race_bearing="b21"))
        simulation.advance(5120, DRIVE)
        forces.append(simulation.advance(4 * 5120, DRIVE).bearing_force[:, names.BEARINGS.index("b21"), 0])
    difference = forces[1] - forces[0]
    window = np.hanning(len(difference))
    spectrum = np.abs(np.fft.rfft(difference * window))
    frequency = np.fft.rfftfreq(len(difference), 1 / 5120)
    wanted = order * RATED / (2 * np.pi)
    energy = spectrum**2
    near = np.zeros(len(frequency), dtype=bool)
    for k in range(1, 40):
        for side in range(-6, 7) if race == "inner" else (0,):
            near |= np.abs(frequency - k * wanted - side * shaft * RATED / (2 * np.pi)) < 0.6
    assert energy[near].sum() > 0.9 * energy[frequency > 1.0].sum()


# --- ramps, checkpoints, refusals -------------------------------------------------------------------------------------


def test_severities_go_linearly_and_turn_back():
    ramps = Ramps()
    ramps.change(FaultSettings(fault_crack=0.4, fault_ramp=10.0), 5.0)
    assert [ramps.at(t)["fault_crack"] for t in (5.0, 7.5, 15.0, 99.0)] == pytest.approx([0.0, 0.1, 0.4, 0.4])
    ramps.change(FaultSettings(fault_crack=0.0, fault_ramp=2.0), 10.0)
    assert [ramps.at(t)["fault_crack"] for t in (10.0, 11.0, 12.0)] == pytest.approx([0.2, 0.1, 0.0])
    ramps.change(FaultSettings(fault_crack=0.3, fault_crack_gear="ring", fault_ramp=1.0), 10.5)
    assert ramps.at(10.5)["fault_crack"] == 0.0  # another tooth begins sound


def test_a_sound_gearbox_is_the_same_to_the_bit_and_so_is_a_healed_one():
    gearbox = Gearbox(CONFIGURATION)
    kept = [np.copy(part) for part in (*gearbox.laws.mesh[2:10], gearbox.laws.bearings.clearance)]
    injection = Injection(gearbox)
    injection.change(FaultSettings(fault_wear=1e-5, fault_clearance=1e-5, fault_crack=0.5), 0.0)
    assert gearbox.laws.teeth.used[0] == 3
    injection.change(FaultSettings(), 1.0)
    parts = (*gearbox.laws.mesh[2:10], gearbox.laws.bearings.clearance)
    assert all(np.array_equal(a, b) for a, b in zip(kept, parts, strict=True))
    assert gearbox.laws.teeth.used[0] == 0
    assert injection.truth(1.0) == {}


def test_a_checkpoint_on_a_ramp_goes_on_bit_for_bit():
    simulation = Simulation(CONFIGURATION, DRIVE)
    simulation.inject(FaultSettings(fault_crack=0.5, fault_race_depth=1e-5, fault_wear=1e-5, fault_ramp=1.0))
    simulation.advance(256, DRIVE)
    later = Simulation.resume(CONFIGURATION, simulation.checkpoint())
    assert later.truth() == simulation.truth()
    for _ in range(4):
        a, b = simulation.advance(64, DRIVE), later.advance(64, DRIVE)
        assert a.x.tobytes() == b.x.tobytes()
    assert float(later.truth()["fault cracked tooth: crack (1)"]) == pytest.approx(0.05, abs=1e-9)
    simulation.advance(64, DRIVE)
    assert math.isclose(float(simulation.truth()["fault cracked tooth: crack (1)"]), 0.5 * 576 / 5120, rel_tol=1e-6)


def test_the_place_of_a_defect_does_not_depend_on_other_faults():
    """A resumed run meets other severities on their ramps; the laws have to become the same to the bit."""
    alone, first, resumed = Gearbox(CONFIGURATION), Gearbox(CONFIGURATION), Gearbox(CONFIGURATION)
    race = {"fault_race_depth": 1e-5, "fault_race_bearing": "sb"}
    other = {"fault_clearance": 2e-4, "fault_clearance_bearing": "sb", "fault_eccentricity": 2e-4}
    Injection(alone).change(FaultSettings(**race), 0.0)
    injection = Injection(first)
    injection.change(FaultSettings(**race, **other, fault_ramp=10.0), 0.0)
    for time in (0.0125, 5.0):
        injection.apply(time)
    Injection(resumed).restore(injection.state(), 5.0)
    assert first.laws.bearings.marks.angle[0] == alone.laws.bearings.marks.angle[0]
    for law in ("teeth", "bearings", "mesh"):
        for a, b in zip(getattr(first.laws, law), getattr(resumed.laws, law), strict=True):
            same = [np.array_equal(c, d) for c, d in zip(a, b, strict=True)] if isinstance(a, tuple) else [True]
            assert all(same)
            assert isinstance(a, tuple) or np.array_equal(a, b)


def test_a_session_refuses_at_once_and_keeps_what_it_had():
    """Before it begins too: a live parameter must not end a node later, when the wind is there."""
    session = Session(CONFIGURATION, FixedPoint(CONFIGURATION), "kinematic", "equilibrium", 5120.0)
    session.inject(FaultSettings(fault_crack=0.2))
    with pytest.raises(InputError, match="fault_crack_tooth: expected 0 to 39 on the sun, got 40"):
        session.inject(FaultSettings(fault_crack=0.2, fault_crack_tooth=40))
    assert session.faults == FaultSettings(fault_crack=0.2)


def test_a_tooth_that_is_not_there():
    with pytest.raises(InputError, match="fault_crack_tooth: expected 0 to 39 on the sun, got 40"):
        Injection(Gearbox(CONFIGURATION)).change(FaultSettings(fault_crack_tooth=40), 0.0)
