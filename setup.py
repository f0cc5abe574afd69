"""Install nw_gear as an ament_python package (colcon) or as a plain Python package (pip)."""

from pathlib import Path

from setuptools import setup

NAME = "nw_gear"
NODES = ("wind_node", "gear_sim_node", "gear_monitor_node", "recorder_node", "replay_node")
EXECUTABLES = (*NODES, "nw_gear")


def files(folder: str, *patterns: str) -> list[str]:
    """Files of one folder for data_files."""
    return sorted(str(path) for pattern in patterns for path in Path(folder).glob(pattern))


setup(
    name=NAME,
    version="0.1.0",
    packages=[
        "nw_gear_common",
        "nw_gear_sim",
        "nw_gear_sim.params",
        "nw_gear_sim.physics",
        "nw_gear_sim.integrator",
        "nw_gear_sim.nodes",
        "nw_gear_monitor",
        "nw_gear_monitor.signals",
        "nw_gear_monitor.indicators",
        "nw_gear_monitor.records",
        "nw_gear_monitor.review",
        "nw_gear_monitor.review.figures",
        "nw_gear_monitor.nodes",
    ],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/config", files("config", "*.yaml")),
        (f"share/{NAME}/launch", files("launch", "*.launch.py")),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="nw_gear maintainers",
    maintainer_email="maintainers@users.noreply.nw-gear.example",
    description="Virtual condition monitoring of a wind turbine's planetary gearbox.",
    license="Apache-2.0",
    extras_require={"test": ["pytest"]},
    entry_points={
        "console_scripts": [f"{name} = nw_gear_common.launcher:{name}" for name in EXECUTABLES],
        "nw_gear.commands": [
            "demo = nw_gear_common.demo:demo",
            "review = nw_gear_monitor.review.command:review",
            "info = nw_gear_monitor.records.command_info:info",
            "recover = nw_gear_monitor.records.command_recover:recover",
        ],
    },
)
