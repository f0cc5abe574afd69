"""What a user meets: the executables and the topics, each with one sentence.

The tables of the README are made from this list and from the parameters that each node declares; a test holds it
against what the running nodes really offer.
"""

from __future__ import annotations

from dataclasses import dataclass

from nw_gear_common import names

TABLE = "std_msgs/msg/Float64MultiArray"

EXECUTABLES = {
    "wind_node": "publishes the wind: a Weibull process, constant, a step, a gust, or a file of measurements",
    "gear_sim_node": "integrates the gearbox and publishes what it does",
    "gear_monitor_node": "spectra, Poincaré sections, indicators, states and alarms, online",
    "recorder_node": "records topics to a rosbag2 folder with MCAP storage",
    "replay_node": "publishes a recording again, with `/clock`",
    "dashboard_node": "a live page in the browser, on the loopback address",
    "nw_gear": "the command line: `demo`, `review`, `analyse`, `study`, `equilibrium`, `modes`, `bench`, `info`, "
    "`import`, `recover`",
}


@dataclass(frozen=True)
class Topic:
    """One topic of the public interface.

    Attributes:
        name: relative to the namespace, or absolute; `<b>` and `<mesh>` stand for a bearing and a mesh.
        kind: ROS type.
        node: executable that publishes it.
        content: what is in it; for a table the meaning of a row, then the columns.
        rate: how often it comes.
    """

    name: str
    kind: str
    node: str
    content: str
    rate: str


TOPICS = (
    Topic(names.WIND_SPEED, "geometry_msgs/msg/Vector3Stamped", "wind_node", "x = along the rotor axis, m/s", "10 Hz"),
    Topic(
        names.SHAFTS_TOPIC,
        "sensor_msgs/msg/JointState",
        "gear_sim_node",
        "ring, planet, sun, output: unwrapped angle (rad), speed (rad/s), torque (N m)",
        "`view_rate`",
    ),
    Topic(
        names.MESH_TOPIC,
        "sensor_msgs/msg/JointState",
        "gear_sim_node",
        "the seven meshes: displacement x_n (m), its velocity (m/s), mesh force (N)",
        "`view_rate`",
    ),
    Topic(
        names.bearing_topic("<b>"),
        "geometry_msgs/msg/WrenchStamped",
        "gear_sim_node",
        "bearing force (N)",
        "`view_rate`",
    ),
    Topic(
        names.WAVEFORM,
        TABLE,
        "gear_sim_node",
        "table `sample`: time, mesh phases, x and v of each mesh, forces of the chosen bearings",
        f"every sample, {names.WAVEFORM_BLOCKS_PER_SECOND} blocks/s",
    ),
    Topic(
        names.ACCELERATION,
        TABLE,
        "gear_sim_node",
        "table `sample`: time, acceleration of the housings at the chosen bearings (m/s^2) as sensors show it",
        f"every sample, {names.WAVEFORM_BLOCKS_PER_SECOND} blocks/s",
    ),
    Topic(
        names.TACHO,
        TABLE,
        "gear_sim_node",
        "table `pulse`: time at which a shaft passes each mark",
        "with the pulses",
    ),
    Topic(
        names.TRUTH,
        "diagnostic_msgs/msg/DiagnosticStatus",
        "gear_sim_node",
        "ground truth: excitation, share of time without contact and on the back flank",
        "latched, 1 Hz",
    ),
    Topic(
        names.SPECTRUM, TABLE, "gear_monitor_node", "table `bin`: frequency (Hz), amplitude of each mesh (m)", "1 Hz"
    ),
    Topic(
        names.ORDERS,
        TABLE,
        "gear_monitor_node",
        "table `order`: order of the stage's mesh, amplitude of each mesh (m)",
        "1 Hz",
    ),
    Topic(
        names.section_topic("<stage>"),
        TABLE,
        "gear_monitor_node",
        "table `point`: time, planet, x, v: new Poincaré points since the last message",
        "1 Hz",
    ),
    Topic(
        names.indicators_topic("<mesh>"),
        TABLE,
        "gear_monitor_node",
        "table `row`, one row: time and every indicator of the mesh; NaN while a window fills",
        "1 Hz",
    ),
    Topic(
        names.indicators_topic("<b>"),
        TABLE,
        "gear_monitor_node",
        "table `row`, one row: the same for each bearing in the waveform: force, envelope lines, spectral kurtosis",
        "1 Hz",
    ),
    Topic(
        names.DIAGNOSTICS,
        "diagnostic_msgs/msg/DiagnosticArray",
        "all nodes",
        "state and reason per stage and per bearing; how each node is doing",
        "1 Hz",
    ),
    Topic(
        names.CLOCK,
        "rosgraph_msgs/msg/Clock",
        "gear_sim_node, replay_node",
        "simulated time, where it isn't wall time",
        "each block",
    ),
)


def resolved(topic: Topic) -> tuple[str, ...]:
    """Every absolute name that one entry stands for, in the default namespace."""
    places = {"<b>": names.BEARINGS, "<mesh>": names.MESHES, "<stage>": names.STAGES}
    for mark, members in places.items():
        if mark in topic.name:
            return tuple(f"{names.NAMESPACE}/{topic.name.replace(mark, member)}" for member in members)
    return (topic.name if topic.name.startswith("/") else f"{names.NAMESPACE}/{topic.name}",)
