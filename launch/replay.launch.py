"""A recording again, with a monitor that sees it as if it were live.

ros2 launch nw_gear replay.launch.py uri:=runs/gust rate:=2.0
ros2 launch nw_gear replay.launch.py uri:=runs/gust monitor:=true record:=runs/gust_again dashboard:=true
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, SetEnvironmentVariable, Shutdown
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

PACKAGE = "nw_gear"
DEFAULTS = PathJoinSubstitution([FindPackageShare(PACKAGE), "config", "nodes.yaml"])

ARGUMENTS = (
    ("namespace", PACKAGE, "Namespace of all nodes."),
    ("params_file", DEFAULTS, "ROS parameter file for all nodes."),
    ("uri", None, "Folder of the recording."),
    ("rate", "1.0", "Recorded seconds per second of wall time."),
    ("loop", "false", "Begin again at the end."),
    ("start_offset", "0.0", "Recorded seconds to leave out at the beginning."),
    ("monitor", "false", "Compute the indicators anew, in the namespace again/<namespace>."),
    ("config", "", "Configuration of that monitor: a YAML file, or the name of a preset."),
    ("machine", "", "Another machine than the built-in gearbox for that monitor: a YAML file."),
    ("record", "", "New folder for what that monitor says; empty = don't record."),
    ("dashboard", "false", "Live page of what is replayed, on the loopback address; its address is printed."),
    ("port", "0", "Port of that page; 0 = any free one."),
    ("domain", "", "ROS domain of all nodes; empty = that of the environment."),
)


def given(name: str, kind: type) -> ParameterValue:
    """A launch argument as a ROS parameter of a fixed type."""
    return ParameterValue(LaunchConfiguration(name), value_type=kind)


# Suites in other namespaces keep time by clocks of their own.
CLOCK = PythonExpression(
    ["'/clock' if '", LaunchConfiguration("namespace"), f"'.strip('/') == '{PACKAGE}' else '/' + '",
     LaunchConfiguration("namespace"), "'.strip('/') + '/clock'"]
)  # fmt: skip


def wanted(name: str) -> PythonExpression:
    """Whether a launch argument says true."""
    return PythonExpression(["'", LaunchConfiguration(name), "'.lower() in ('true', '1')"])


def named(name: str) -> PythonExpression:
    """Whether a launch argument isn't empty."""
    return PythonExpression(["'", LaunchConfiguration(name), "' != ''"])


def node(executable: str, parameters: dict, **kwargs) -> Node:
    """One node of this package."""
    files = [LaunchConfiguration("params_file"), parameters]
    clock = [("/clock", CLOCK)]
    return Node(package=PACKAGE, executable=executable, parameters=files, remappings=clock, output="screen", **kwargs)


def generate_launch_description() -> LaunchDescription:
    """Start the replay, and what is wanted beside it; the end of the replay ends everything."""
    here, again = LaunchConfiguration("namespace"), ["again/", LaunchConfiguration("namespace")]
    audience = PythonExpression(["int(", wanted("monitor"), ") + int(", wanted("dashboard"), ")"])
    replayed = {
        "uri": given("uri", str),
        "rate": given("rate", float),
        "loop": given("loop", bool),
        "start_offset": given("start_offset", float),
        "wait_for": ParameterValue(audience, value_type=int),
    }
    monitored = {
        "config": given("config", str),
        "machine": given("machine", str),
        "waveform_topic": ParameterValue(["/", LaunchConfiguration("namespace"), "/waveform"], value_type=str),
        "use_sim_time": True,
    }
    clocked = {"use_sim_time": True}
    return LaunchDescription(
        [
            *(DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS),
            SetEnvironmentVariable(
                "ROS_DOMAIN_ID", LaunchConfiguration("domain"), condition=IfCondition(named("domain"))
            ),
            node(
                "recorder_node",
                {"uri": given("record", str), **clocked},
                namespace=again,
                condition=IfCondition(named("record")),
            ),
            node("gear_monitor_node", monitored, namespace=again, condition=IfCondition(wanted("monitor"))),
            node(
                "dashboard_node",
                {"port": given("port", int), **clocked},
                namespace=here,
                condition=IfCondition(wanted("dashboard")),
            ),
            node("replay_node", replayed, namespace=here, on_exit=Shutdown()),
        ]
    )
