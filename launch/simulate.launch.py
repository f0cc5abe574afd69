"""Wind, gearbox and monitor, a recorder where a folder is named, and a live page where one is wanted.

ros2 launch nw_gear simulate.launch.py
ros2 launch nw_gear simulate.launch.py wind:=gust seed:=3 record:=runs/gust real_time_factor:=0.0
ros2 launch nw_gear simulate.launch.py namespace:=turbine_7 domain:=7 dashboard:=true
ros2 launch nw_gear simulate.launch.py config:=rated scenario:=grid_loss
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
NOT_REAL_TIME = PythonExpression([LaunchConfiguration("real_time_factor"), " != 1.0"])

ARGUMENTS = (
    ("namespace", PACKAGE, "Namespace of all nodes."),
    ("params_file", DEFAULTS, "ROS parameter file for all nodes."),
    ("config", "", "Configuration laid over the default gearbox: a YAML file, or the name of a preset."),
    ("wind", "weibull", "Source of the wind: weibull, constant, step, gust or file."),
    ("wind_file", "", "CSV file of the measured wind, for wind:=file."),
    ("seed", "1", "Seed of the wind."),
    ("real_time_factor", "1.0", "Simulated seconds per second of wall time; 0.0 = as fast as possible."),
    ("use_sim_time", NOT_REAL_TIME, "Follow /clock; by itself true where real_time_factor isn't 1."),
    ("duration", "0.0", "Simulated seconds after which everything ends; 0.0 = never."),
    ("scenario", "", "Instead of the wind: start_up, shutdown, emergency_stop or grid_loss."),
    ("drive_file", "", "Instead of the wind: speed and torque from OpenFAST or a SCADA system."),
    ("record", "", "New folder of the recording; empty = don't record."),
    ("dashboard", "false", "Live page on the loopback address; its address is printed."),
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


def node(executable: str, parameters: dict, **kwargs) -> Node:
    """One node of this package in the common namespace."""
    return Node(
        package=PACKAGE,
        executable=executable,
        namespace=LaunchConfiguration("namespace"),
        parameters=[LaunchConfiguration("params_file"), parameters],
        remappings=[("/clock", CLOCK)],
        output="screen",
        **kwargs,
    )


def generate_launch_description() -> LaunchDescription:
    """Start the suite; the end of the simulator ends everything."""
    clocked = {"use_sim_time": given("use_sim_time", bool)}
    config = {"config": given("config", str)}
    wind = {"source": given("wind", str), "file": given("wind_file", str), "seed": given("seed", int)}
    load = {"scenario": given("scenario", str), "drive_file": given("drive_file", str)}
    pace = {"real_time_factor": given("real_time_factor", float), "duration": given("duration", float)}
    recorded = PythonExpression(["'", LaunchConfiguration("record"), "' != ''"])
    watched = PythonExpression(["'", LaunchConfiguration("dashboard"), "'.lower() in ('true', '1')"])
    count = PythonExpression(["1 + int(", recorded, ") + int(", watched, ")"])
    audience = {"wait_for": ParameterValue(count, value_type=int)}
    elsewhere = PythonExpression(["'", LaunchConfiguration("domain"), "' != ''"])
    return LaunchDescription(
        [
            *(DeclareLaunchArgument(name, default_value=value, description=text) for name, value, text in ARGUMENTS),
            SetEnvironmentVariable("ROS_DOMAIN_ID", LaunchConfiguration("domain"), condition=IfCondition(elsewhere)),
            node("recorder_node", {"uri": given("record", str), **clocked}, condition=IfCondition(recorded)),
            node("gear_monitor_node", {**config, **clocked}),
            node("dashboard_node", {"port": given("port", int), **clocked}, condition=IfCondition(watched)),
            node("gear_sim_node", {**config, **load, **pace, **audience}, on_exit=Shutdown()),
            node("wind_node", {**config, **wind, **clocked}),
        ]
    )
