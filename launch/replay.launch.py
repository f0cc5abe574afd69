"""A recording again, with a monitor that sees it as if it were live.

ros2 launch nw_gear replay.launch.py uri:=runs/gust rate:=2.0
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, Shutdown
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
)


def given(name: str, kind: type) -> ParameterValue:
    """A launch argument as a ROS parameter of a fixed type."""
    return ParameterValue(LaunchConfiguration(name), value_type=kind)


def generate_launch_description() -> LaunchDescription:
    """Start the replay, and a monitor beside it where it is wanted; the end of the replay ends everything."""
    audience = PythonExpression(["int('", LaunchConfiguration("monitor"), "' == 'true')"])
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
    return LaunchDescription(
        [
            *(DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS),
            Node(
                package=PACKAGE,
                executable="replay_node",
                namespace=LaunchConfiguration("namespace"),
                parameters=[LaunchConfiguration("params_file"), replayed],
                output="screen",
                on_exit=Shutdown(),
            ),
            Node(
                package=PACKAGE,
                executable="gear_monitor_node",
                namespace=["again/", LaunchConfiguration("namespace")],
                parameters=[LaunchConfiguration("params_file"), monitored],
                output="screen",
                condition=IfCondition(LaunchConfiguration("monitor")),
            ),
        ]
    )
