"""The robot under ROS 2: driver, launch file and descriptions, which are copied into a package."""
