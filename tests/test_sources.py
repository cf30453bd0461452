"""Logs without units whose header says who wrote them open at the first try, in SI."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from simcompare.errors import InputError
from simcompare.hardware import mapping
from simcompare.hardware.logs import importers, profiles
from simcompare.hardware.logs.text import cell
from simcompare.verbs.import_log import import_log

#: g_0 by its definition [m/s^2]
G = 9.80665
DEG = np.pi / 180


def rows(template, count=40, step=0.01):
    """Lines of numbers: {t} is the time in s, {ms}, {us} and {ns} that in its units, {n} counts."""
    made = []
    for n in range(count):
        t = n * step
        wave = 0.1 * np.sin(7 * t)
        values = {"t": f"{t:.4f}", "n": n, "ms": round(1e3 * t), "us": round(1e6 * t),
                  "ns": 1711111111000000000 + round(1e9 * t), "w": f"{wave:.5f}",
                  "epoch": f"{1711111111 + t:.4f}",
                  "tc": f"{t:.4f}".replace(".", ","), "h": f"{n:02d}"}  # fmt: skip
        made.append(template.format(**values))
    return "\n".join(made) + "\n"


#: file name, header, row, channel -> its value in the middle
CASES = {
    "sensor logger accelerometer": (
        "Accelerometer.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},0.5,{w},0.25",
        {"z_m_s2": 0.5, "x_m_s2": 0.25},
    ),
    "sensor logger with gravity": (
        "TotalAcceleration.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},9.81,{w},0.25",
        {"z_m_s2": 9.81},
    ),
    "sensor logger gyroscope": (
        "Gyroscope.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},0.5,{w},0.25",
        {"z_rad_s": 0.5},
    ),
    "sensor logger magnetometer": (
        "Magnetometer.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},40,{w},20",
        {"z_T": 40e-6},
    ),
    "sensor logger barometer": (
        "Barometer.csv", "time,seconds_elapsed,relativeAltitude,pressure\n",
        "{ns},{t},0.5,1013.25", {"pressure_Pa": 101325.0, "relativealtitude_m": 0.5},
    ),
    "sensor logger orientation": (
        "Orientation.csv", "time,seconds_elapsed,yaw,qx,qz,roll,qw,qy,pitch\n",
        "{ns},{t},0.5,0,0,{w},1,0,0.1", {"yaw_rad": 0.5, "qw": 1.0},
    ),
    "sensor logger gravity": (
        "Gravity.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},9.8,{w},0.25", {"z_m_s2": 9.8},
    ),
    "sensor logger compass": (
        "Compass.csv", "time,seconds_elapsed,magneticBearing\n", "{ns},{t},90",
        {"magneticbearing_rad": 90 * DEG},
    ),
    "sensor logger location": (
        "Location.csv", "time,seconds_elapsed,speed,altitude,latitude\n", "{ns},{t},1.5,80,52",
        {"speed_m_s": 1.5, "altitude_m": 80.0, "latitude_rad": 52 * DEG},
    ),
    "physics toolbox": (
        "walk.csv", "time,gFx,gFy,gFz,ax,ay,az,wx,wy,wz,p,Bx,By,Bz\n",
        "{t},0.01,0.02,1.003,0.1,{w},0.3,0.1,0.2,0.3,1013.2,20,30,40",
        {"gfz_m_s2": 1.003 * G, "ax_m_s2": 0.1, "wz_rad_s": 0.3, "p_Pa": 101320.0, "bx_T": 20e-6},
    ),
    "physics toolbox, decimal comma": (
        "walk.csv", "time;gFx;gFy;gFz;TgF\n", "{tc};0,01;0,02;1,003;1,003",
        {"gfz_m_s2": 1.003 * G},
    ),
    "tum": (
        "poses.txt", "# timestamp tx ty tz qx qy qz qw\n", "{epoch} 1.5 {w} 0.5 0 0 0 1",
        {"tx_m": 1.5, "qw": 1.0},
    ),
    "tum without a header": (
        "poses.txt", "", "{epoch} 1.5 {w} 0.5 0 0 0 1", {"tx_m": 1.5, "qw": 1.0},
    ),
    "tum with commas": (
        "poses.csv", "timestamp,tx,ty,tz,qx,qy,qz,qw\n", "{epoch},1.5,{w},0.5,0,0,0,1",
        {"tz_m": 0.5},
    ),
    "movella dot": (
        "dot.csv",
        "sep=,\nDeviceTag:,1\nFirmwareVersion:,3.0.0\nOutputRate:,100Hz\n\n"
        "PacketCounter,SampleTimeFine,Euler_X,Euler_Y,Euler_Z,FreeAcc_X,FreeAcc_Y,FreeAcc_Z\n",
        "{n},{us},-90,{w},45,0.5,-0.1,0.2",
        {"euler_x_rad": -90 * DEG, "freeacc_x_m_s2": 0.5},
    ),
    "mt manager": (
        "mt.txt", "// Update Rate: 100.0Hz\n// Firmware Version: 4.0.2\n"
        "PacketCounter\tSampleTimeFine\tAcc_X\tAcc_Y\tAcc_Z\tRoll\n",
        "{n}\t\t0.1\t{w}\t9.8\t90", {"acc_z_m_s2": 9.8, "roll_rad": 90 * DEG},
    ),
    "crazyflie": (
        "log.csv", "time,stateEstimate.x,stabilizer.roll,acc.z,pm.vbat,\n", "{ms},1.5,90,{w},3.7,",
        {"stateestimate_x_m": 1.5, "stabilizer_roll_rad": 90 * DEG, "pm_vbat_V": 3.7},
    ),
    "klipper": (
        "adxl345-x.csv", "#time,accel_x,accel_y,accel_z\n", "{t},10,{w},9806.65",
        {"accel_z_m_s2": G},
    ),
    "saleae": ("analog.csv", "Time [s],Channel 0,supply\n", "{t},1.5,{w}", {"channel_0_V": 1.5}),
    "science journal": (
        "run.csv", "relative_time,AccX,AccY,AccZ,BarometerSensor,MagneticRotationSensor\n",
        "{ms},{w},0.1,9.8,1013,40", {"accz_m_s2": 9.8, "barometersensor_Pa": 101300.0,
                                    "magneticrotationsensor_T": 40e-6},
    ),
    "imu of ros with underscores": (
        "imu.csv", "time,linear_acceleration_x,linear_acceleration_y,linear_acceleration_z,"
        "angular_velocity_x\n", "{t},0.1,{w},9.8,0.5",
        {"linear_acceleration_z_m_s2": 9.8, "angular_velocity_x_rad_s": 0.5},
    ),
    "scan of ros": (
        "scan.csv", "%time,field.header.stamp,field.angle_min,field.scan_time,field.ranges0\n",
        "{ns},{ns},0.5,0.1,{n}.5",
        {"field_angle_min_rad": 0.5, "field_scan_time_s": 0.1},
    ),
    "forces of opensim, a side in the name": (
        "grf.mot", "grf\nversion=1\nnRows=40\nnColumns=4\ninDegrees=no\nendheader\n"
        "time\tground_force_r_vy\tground_force_1_px\tground_torque_r_x\n", "{t}\t700\t{w}\t2",
        {"ground_force_r_vy_N": 700.0, "ground_torque_r_x_N_m": 2.0},
    ),
    "vesc tool": (
        "log.csv",
        "ms_today;input_voltage;temp_motor;current_motor;erpm;duty_cycle;amp_hours_used;"
        "roll;accZ;gyroX;speed_meters_per_sec;\n",
        "{ms};40.5;25;1.5;{n};0.3;0.5;0.25;1;90;2.5;",
        {"input_voltage_V": 40.5, "temp_motor_K": 298.15, "current_motor_A": 1.5,
         "duty_cycle": 0.3, "amp_hours_used_A_s": 1800.0, "roll_rad": 0.25, "accz_m_s2": G,
         "gyrox_rad_s": 90 * DEG, "speed_meters_per_sec_m_s": 2.5},
    ),
    "betaflight": (
        "flight.csv", "loopIteration,time (us),gyroADC[0],vbatLatest (V)\n", "{n},{us},5,16.5",
        {"vbatlatest_V": 16.5},
    ),
    "betaflight with its head": (
        "flight.csv", '"Product","Blackbox flight data recorder"\n"blackbox_high_resolution","0"\n'
        '"loopIteration","time","gyroADC[0]"\n', "{n},{us},90",
        {"gyroadc_0_rad_s": 90 * DEG},
    ),
    "px4 sensor_combined": (
        "x_sensor_combined_0.csv",
        "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0],"
        "accelerometer_m_s2[1],accelerometer_m_s2[2]\n", "{us},0.1,0.2,{w},0.1,0.2,-9.8",
        {"gyro_rad_0_rad_s": 0.1, "accelerometer_m_s2_2_m_s2": -9.8},
    ),
    "px4 local position": (
        "x_vehicle_local_position_0.csv", "timestamp,x,y,z,vx,vy,vz,heading\n",
        "{us},1.5,{w},-2,0.5,0,0,0.75", {"x_m": 1.5, "vx_m_s": 0.5, "heading_rad": 0.75},
    ),
    "px4 attitude": (
        "x_vehicle_attitude_0.csv", "timestamp,q[0],q[1],q[2],q[3]\n", "{us},1,0,0,0",
        {"q_0": 1.0},
    ),
    "px4 gyroscope": (
        "x_sensor_gyro_0.csv", "timestamp,device_id,x,y,z,temperature\n",
        "{us},1234567,0.1,{w},0.3,25", {"x_rad_s": 0.1, "temperature_K": 298.15},
    ),
    "px4 battery": (
        "x_battery_status_0.csv", "timestamp,voltage_v,current_a,remaining\n",
        "{us},16.1,12.5,0.5", {"voltage_V": 16.1, "current_A": 12.5, "remaining": 0.5},
    ),
    "ardupilot imu": (
        "imu.csv", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ,T\n",
        "{us},0,0.1,0.2,{w},0.1,0.2,-9.8,35",
        {"gyrx_rad_s": 0.1, "accz_m_s2": -9.8, "t_K": 308.15},
    ),
    "ardupilot attitude": (
        "att.csv", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw\n", "{us},0,90,0,{w},0,45",
        {"roll_rad": 90 * DEG, "yaw_rad": 45 * DEG},
    ),
    "motive": (
        "take.csv",
        "Format Version,1.23,Take Name,A,Export Frame Rate,100.0,Rotation Type,Quaternion,"
        "Length Units,Millimeters,Coordinate Space,Global\n\n"
        ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Marker\n"
        ",Name,Box,Box,Box,Box,Box:1\n,ID,1,1,1,1,A1D3\n"
        ",,Rotation,Rotation,Position,Position,Position\nFrame,Time (Seconds),X,W,X,Y,X\n",
        "{n},{t},0.1,0.9,1500,{w},1200",
        {"box_rotation_w": 0.9, "box_position_x_m": 1.5, "box_1_position_x_m": 1.2},
    ),
    "motive in metres with angles": (
        "take.csv",
        "Format Version,1.23,Rotation Type,XYZ,Length Units,Meters\n\n"
        ",Type,Rigid Body,Rigid Body\n,Name,Box,Box\n,ID,1,1\n,,Rotation,Position\n"
        "Frame,Time (Seconds),X,X\n", "{n},{t},90,1.5",
        {"box_rotation_x_rad": 90 * DEG, "box_position_x_m": 1.5},
    ),
    "nexus": (
        "trial.csv",
        "Trajectories,,,,,,,\n100,,,,,,,\n,,box:left,,,box:right,,\n"
        "Frame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n",
        "{n},0,1500,{w},2,3,4,5", {"box_left_x_m": 1.5, "box_right_z_m": 0.005},
    ),
    "nexus with one marker": (
        "trial.csv", "Trajectories\n100\n,,ball,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n",
        "{n},0,1500,{w},2", {"ball_x_m": 1.5},
    ),
    "qualisys": (
        "run.tsv",
        "NO_OF_FRAMES\t40\nNO_OF_MARKERS\t2\nFREQUENCY\t100\nDATA_INCLUDED\t3D\n"
        "MARKER_NAMES\tknee\tankle\n", "1500\t{w}\t2\t3\t4\t5",
        {"knee_x_m": 1.5, "ankle_z_m": 0.005},
    ),
    "qualisys with names of columns": (
        "run.tsv",
        "NO_OF_FRAMES\t40\nFREQUENCY\t100\nMARKER_NAMES\tknee\n"
        "Frame\tTime\tknee X\tknee Y\tknee Z\n", "{n}\t{t}\t1500\t{w}\t2",
        {"knee_x_m": 1.5},
    ),
    "rigol without x": (
        "NewFile1.csv", "CH1,CH3,Start,Increment,\nVolt,Volt,-0.1,0.01,\n", "1.5,{w},,",
        {"ch1_V": 1.5},
    ),
    "bag by bagpy": (
        "imu-data.csv",
        "Time,header.seq,header.frame_id,orientation.w,angular_velocity.x,linear_acceleration.z\n",
        "{epoch},{n},imu,1,0.1,9.8",
        {"orientation_w": 1.0, "angular_velocity_x_rad_s": 0.1, "linear_acceleration_z_m_s2": 9.8},
    ),
    "plotjuggler": (
        "run.csv", "__time,/odom/pose/pose/position/x,/odom/twist/twist/angular/z\n",
        "{epoch},1.5,0.2",
        {"odom_pose_pose_position_x_m": 1.5, "odom_twist_twist_angular_z_rad_s": 0.2},
    ),
    "rostopic": (
        "imu.csv", "%time,field.header.seq,field.header.stamp,field.angular_velocity.x\n",
        "{ns},{n},{ns},0.1", {"field_angular_velocity_x_rad_s": 0.1},
    ),
    "groups over axes": (
        "trial.csv", "Time;IMU Acceleration;;;IMU Gyroscope;;\ns;X;Y;Z;X;Y;Z\n"
        ";m/s^2;m/s^2;m/s^2;rad/s;rad/s;rad/s\n", "{t};0.1;{w};9.8;0.1;0.2;0.3",
        {"imu_acceleration_z_m_s2": 9.8, "imu_gyroscope_x_rad_s": 0.1},
    ),
    "markers of opensim": (
        "walk.trc", "PathFileType\t4\t(X/Y/Z)\twalk.trc\n"
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\n"
        "100\t100\t40\t2\tmm\t100\nFrame#\tTime\theel\t\t\ttoe\t\t\n"
        "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n",
        "{n}\t{t}\t500\t2\t3\t4\t5\t250", {"heel_x1_m": 0.5, "toe_z2_m": 0.25, "frame": 20},
    ),
    "coordinates of opensim": (
        "ik.mot", "Coordinates\nversion=1\nnRows=40\nnColumns=3\ninDegrees=yes\n\nendheader\n"
        "time\tpelvis_tx\tknee_angle_r\n", "{t}\t0.5\t90",
        {"pelvis_tx_m": 0.5, "knee_angle_r_rad": 90 * DEG},
    ),
    "speeds of opensim": (
        "u.sto", "Speeds\nversion=1\ninDegrees=yes\nendheader\ntime\tpelvis_tx\tknee_angle_r\n",
        "{t}\t0.5\t90", {"pelvis_tx_m_s": 0.5, "knee_angle_r_rad_s": 90 * DEG},
    ),
    "ground forces of opensim": (
        "grf.mot", "name grf.mot\ndatacolumns 4\nendheader\n"
        "time\tR_ground_force_vy\tR_ground_force_px\tR_ground_torque_y\n", "{t}\t700\t0.25\t{w}",
        {"r_ground_force_vy_N": 700.0, "r_ground_force_px_m": 0.25},
    ),
    "torques of opensim": (
        "id.sto", "Inverse Dynamics Generalized Forces\nversion=1\ninDegrees=no\nendheader\n"
        "time\tpelvis_tx_force\tknee_angle_r_moment\n", "{t}\t500\t-20",
        {"pelvis_tx_force_N": 500.0, "knee_angle_r_moment_N_m": -20.0},
    ),
    "objects of vicon": (
        "objects.csv", "Objects\n100\n,,Global Angle (Quaternion) cube:cube,,,,,,\n"
        "Frame,Sub Frame,RX,RY,RZ,RW,TX,TY,TZ\n,,,,,,mm,mm,mm\n",
        "{n},0,0,0,0,1,250,{w},3",
        {"global_angle_quaternion_cube_cube_tx_m": 0.25,
         "global_angle_quaternion_cube_cube_rw": 1.0},
    ),
    "counted channels of vicon": (
        "emg.csv", "Devices\n100\n,,Analog EMG - Voltage,,Sensor 1\nFrame,Sub Frame,1,2,EMG1\n"
        ",,V,V,V\n", "{n},0,0.5,{w},0.25", {"c_1_V": 0.5, "emg1_V": 0.25},
    ),
    "rigol without a unit of the time": (
        "scope.csv", "X,CH 1 (V),CH 2 (V)\n", "{t},0.5,{w}", {"ch_1_V": 0.5},
    ),
    "settings of rigol above the header": (
        "scope.csv", '"Pos (V) = ",0.2,-6\n"Maximum (V) = ",1.88,5.12\n"Inverted = ","NO","NO"\n'
        '"Time (s)","Voltage (V)","Voltage (V)"\n', "{t},0.5,0.25",
        {"voltage_V": 0.5, "voltage_2_V": 0.25},
    ),
    "remarks that end with a comma": (
        "waveforms.csv", "#Digilent WaveForms Oscilloscope Acquisition,\n#Serial Number: SN:0,\n"
        ",\nTime (s),Channel 1 (V)\n", "{t},0.5", {"channel_1_V": 0.5},
    ),
    "remarks above names that are alike": (
        "OpenBCI.txt", "%OpenBCI Raw EXG Data\n%Rate = 250 Hz\nTimestamp, Other, Other, u_V\n",
        "{epoch}, 1, 2, 0.5", {"u_V": 0.5},
    ),
    "altos": (
        "flight.csv", "#version,serial,flight,call,time,state_name,acceleration,pressure,altitude,"
        "height,speed,temperature,battery_voltage,altitude,hour,minute,second\n",
        "6, 20, 12,N0CALL, {t}, boost, 3.5, 98235, 260, 11, -0.5, 20, 3.9, 218, 20, 7, 50",
        {"acceleration_m_s2": 3.5, "pressure_Pa": 98235.0, "temperature_K": 293.15,
         "speed_m_s": -0.5, "battery_voltage_V": 3.9, "altitude_2_m": 218.0},
    ),
    "an older mt manager": (
        "mt.txt", "// Start Time: 0\n// Sample rate: 100.0Hz\nCounter\tAcc_X\tAcc_Y\tAcc_Z\tQuat_w"
        "\n",
        "{n}\t0.5\t{w}\t9.81\t1", {"acc_z_m_s2": 9.81, "quat_w": 1.0},
    ),
    "quaternions of x-io": (
        "Quaternion.csv", "Timestamp (us),W,X,Y,Z\n", "{us},0.6,0,0.8,0", {"w": 0.6, "y": 0.8},
    ),
    "arduino's stamps": (
        "monitor.txt", "09:41:06.990 -> force_N,angle_deg\n", "09:41:07.{h}0 -> 0.5,90",
        {"force_N": 0.5, "angle_rad": 90 * DEG},
    ),
    "arduino's stamps and tabs": (
        "monitor.txt", "09:41:06.990 -> force_N\tangle_deg\n", "09:41:07.{h}0 -> 0.5\t90",
        {"force_N": 0.5, "angle_rad": 90 * DEG},
    ),
    "stamps in brackets": (
        "coolterm.txt", "", "[09:41:07.{h}0] force_N=0.5 temp: 20 C",
        {"force_N": 0.5, "temp_K": 293.15},
    ),
    "labels with units": (
        "stand.txt", "Ready.\n", "Time: {ms} ms, Thrust: 1.5lbf, Torque: 0.12 Nm",
        {"thrust_N": 1.5 * 4.4482216152605, "torque_N_m": 0.12},
    ),
    "numbers of an accelerometer that tell their unit": (
        "AccelerometerUncalibrated.csv", "time,seconds_elapsed,z,y,x\n", "{ns},{t},1,{w},0",
        {"z_m_s2": G},
    ),
    "sensor logger under longer names": (
        "TotalAcceleration.csv", "Timestamp,seconds_elapsed,AccelerationZ\n", "{ns},{t},9.81",
        {"accelerationz_m_s2": 9.81},
    ),
    "sensor fusion": ("run1.txt", "", "{ms}\tACC\t0.5\t{w}\t9.81", {"z_m_s2": 9.81}),
    "euler angles of a vmu931": ("euler.csv", "", "euler,{ms},90,{w},1", {"x_rad": 90 * DEG}),
    "quaternions of a vmu931": (
        "q.csv", "Attribute,Time stamp,w,x,y,z\n", "Quaternion,{ms},0.6,0,0.8,0", {"y": 0.8},
    ),
    "channels of saleae": (
        "bus.csv", "Time [s],Channel 0,Channel 1\n", "{t},1,0", {"channel_0": 1.0},
    ),
    "labview without its head": (
        "data.lvm", "X_Value\tforce (N)\tComment\n", "{t}\t1.5", {"force_N": 1.5},
    ),
    "cells with their units": (
        "lift.csv", "time,height,speed\n", "{t}s,150cm,2 m/s", {"height_m": 1.5, "speed_m_s": 2.0},
    ),
    "a bag as csv, with its messages in empty columns": (
        "odom.csv", "rosbagTimestamp,header,seq,pose,pose,position,x,y,orientation,x,w,twist,x\n",
        "{ns},,{n},,,,1.5,{w},,0.6,0.8,,2", {"pose_pose_position_x_m": 1.5, "orientation_w": 0.8},
    ),
    "labels of a plotter": (
        "plot.txt", "", "t_ms:{ms}\tforce_N:0.5\tangle_deg:90",
        {"force_N": 0.5, "angle_rad": 90 * DEG},
    ),
    "labels after the name of a sensor": (
        "esp32.txt", "ets Jun  8 2016 00:22:57\nrst:0x1 (POWERON_RESET)\n",
        "IMU: t_ms: {ms} roll_deg: 90 pitch_deg: {w}", {"roll_rad": 90 * DEG},
    ),
    "putty": (
        "putty.log", "=~=~=~=~= PuTTY log 2024.03.22 10:00:00 =~=~=~=~=\nt_ms,force_N\n",
        "{ms},0.5", {"force_N": 0.5},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_log_of_a_known_source_opens_at_the_first_try(case, tmp_path):
    name, header, row, expected = CASES[case]
    path = tmp_path / name
    path.write_text(header + rows(row), encoding="utf-8")
    recording = import_log(path)
    channels = {k: v for s in recording.streams.values() for k, v in s.channels.items()}
    for channel, value in expected.items():
        assert channel in channels, sorted(channels)
        middle = channels[channel].values[20]
        assert middle == pytest.approx(value, rel=1e-9, abs=1e-12)  # only conversions
    stream = next(iter(recording.streams.values()))
    assert stream.time_s[-1] == pytest.approx(0.39, abs=1e-3)  # stamps of 1 ms at the coarsest


def test_the_recording_says_what_was_recognised(tmp_path):
    path = tmp_path / "Accelerometer.csv"
    path.write_text(
        "time,seconds_elapsed,z,y,x\n" + rows("{ns},{t},0.5,{w},0.25"), encoding="utf-8"
    )
    recording = import_log(path)
    texts = [r.text for r in recording.provenance.repairs if r.rule == "source"]
    assert texts == [
        "recognised as Sensor Logger (acceleration without gravity), which defines the units"
    ]
    assert recording.streams["log"].channels["z_m_s2"].kind == "gravity_removed"
    assert recording.streams["log"].clock.start.startswith("2024-03-22T12:38:31")


def test_values_of_a_vesc_in_json_have_the_units_of_their_library(tmp_path):
    # rpm is the electrical speed there: pole pairs times that of the shaft
    path = tmp_path / "VESC.TXT"
    line = '{{"avgMotorCurrent":1.5,"inpVoltage":12.5,"wattHours":1.0,"rpm":700,"t":{t}}}'
    path.write_text("".join(line.format(t=0.1 * n) + "\n" for n in range(40)))
    stream = import_log(path).streams["log"]
    assert stream.channels["inpvoltage_V"].values[0] == 12.5
    assert stream.channels["watthours_J"].values[0] == 3600.0
    assert [name for name in stream.channels if name.startswith("rpm")] == []


def test_joints_of_a_known_robot_are_what_its_description_says():
    panda = [f"panda_joint{n}" for n in range(1, 8)]
    found = profiles.robot([*panda, "panda_finger_joint1"])
    assert found is not None
    assert found.name == "Franka Panda"
    # one joint alone, or joints that others have too, are no robot
    assert profiles.robot(panda[:6]) is None
    assert profiles.robot(["joint1", "joint2", "joint3", "elbow_joint"]) is None


def test_every_robot_is_known_by_joints_that_it_describes():
    for source in profiles.sources().values():
        for robot in source.robots:
            kinds = [robot.revolute, robot.prismatic]
            for joint in robot.known_by:
                assert sum(bool(k and re.fullmatch(k, joint)) for k in kinds) == 1, joint


def test_a_name_that_says_nothing_gives_no_units():
    # three axes of any sensor: only the name of the file said which
    assert (
        profiles.find("walk.csv", [], [(n, "") for n in ("time", "seconds_elapsed", "x")]) is None
    )


@pytest.mark.parametrize("name", ["position.x", "orientation.x", "linear_acceleration_x"])
def test_words_that_others_use_too_are_no_sign_of_ros(name):
    # a game, an Euler angle, a sensor that takes gravity off
    assert profiles.find("log.csv", [], [("time", ""), (name, "")]) is None


def test_every_unit_of_a_source_is_one():
    from simcompare import units

    for source in profiles.sources().values():
        for table in source.tables:
            for quantity in table.channels.values():
                if quantity.unit not in ("above", "eRPM"):
                    units.si_of(quantity.unit, "")


def test_the_guide_names_every_source():
    guide = (Path(__file__).parent.parent / "docs" / "logs.md").read_text(encoding="utf-8")
    assert [s.title for s in profiles.sources().values() if s.title not in guide] == []


def test_a_unit_that_the_log_says_stays():
    found = profiles.find(
        "Gyroscope.csv", [], [("time", ""), ("seconds_elapsed", ""), ("x", "deg/s")]
    )
    assert found is not None
    assert found.names[2] == ("x", "deg/s")


def test_a_reset_of_the_board_begins_another_stream(tmp_path):
    path = tmp_path / "serial.txt"
    boot = "ets Jun  8 2016 00:22:57\nrst:0x1 (POWERON_RESET),boot:0x13\n"
    path.write_text(f"t_ms,force_N\n{rows('{ms},0.5')}{boot}{rows('{ms},1.5')}", encoding="utf-8")
    recording = import_log(path)
    assert [*recording.streams] == ["run_1", "run_2"]
    forces = [s.channels["force_N"].values for s in recording.streams.values()]
    assert [len(force) for force in forces] == [40, 40]
    assert [force[0] for force in forces] == [0.5, 1.5]
    restart = [r for r in recording.provenance.repairs if r.rule == "restart"]
    assert [repair.rows for repair in restart] == [((44, 44),)]


def test_a_counter_that_wraps_is_no_reset():
    from simcompare.hardware.logs.text import restarts
    from simcompare.hardware.raw import RawColumn, RawStream

    ticks = np.arange(65500, 65600.0) % 65536
    stream = RawStream("log", [RawColumn("t", ticks), RawColumn("x", ticks.copy())], "t")
    assert restarts.after_restarts(stream)[0] == [stream]


def test_the_first_value_behind_a_stamp_stays(tmp_path):
    path = tmp_path / "monitor.txt"
    path.write_text(rows("09:41:07.{h}0 -> 0.5,0.10,9.79"), encoding="utf-8")
    raw = importers.read(path, importers.recognise(path), mapping.NOTHING)
    assert [c.values[7] for c in raw.streams[0].columns[1:]] == [0.5, 0.10, 9.79]
    assert raw.streams[0].columns[0].values[7] == pytest.approx(0.07, abs=1e-9)  # of doubles


def test_the_time_of_day_of_a_console_passes_midnight(tmp_path):
    path = tmp_path / "monitor.txt"
    stamps = [f"23:59:59.{900 + 20 * i}" for i in range(5)]
    stamps += [f"00:00:00.{20 * i:03d}" for i in range(10)]
    path.write_text("".join(f"{s} -> force_N=0.5\n" for s in stamps), encoding="utf-8")
    stream = import_log(path).streams["log"]
    assert stream.time_s[-1] == pytest.approx(0.28, abs=1e-9)  # of doubles


def test_matlab_version_4_is_read_and_its_first_row_is_the_time(tmp_path):
    scipy_io = pytest.importorskip("scipy.io")
    path = tmp_path / "bench.mat"
    table = np.vstack([np.arange(40) * 0.002, np.full(40, 0.5), np.full(40, 1.5)])
    scipy_io.savemat(path, {"data": table}, format="4")
    assert importers.recognise(path) == "mat"
    stream = importers.read(path, "mat", mapping.NOTHING).streams[0]
    assert stream.time == "time"
    assert [(c.name, c.values[-1]) for c in stream.columns] == [
        ("time", table[0, -1]), ("data.1", 0.5), ("data.2", 1.5),
    ]  # fmt: skip


def test_a_damaged_file_of_matlab_version_4_is_refused(tmp_path):
    scipy_io = pytest.importorskip("scipy.io")
    path = tmp_path / "bench.mat"
    scipy_io.savemat(path, {"data": np.ones((3, 40))}, format="4")
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(InputError, match="the file ends before"):
        importers.read(path, "mat", mapping.NOTHING)


def test_the_line_for_a_faulty_clock_opens_a_log_without_units(tmp_path):
    # one line is promised: it has to hold the columns too
    stamps = [0.01 * n + (-0.3 if n > 50 else 0.0) for n in range(100)]
    path = tmp_path / "shimmer.csv"
    path.write_text("time,lever\n" + "".join(f"{t:.2f},{np.sin(t):.4f}\n" for t in stamps))
    with pytest.raises(InputError) as refused:
        import_log(path)
    assert re.search(r"\(clock_jump\).*\{time: \{rate_Hz: .*channels: \{", str(refused.value))


@pytest.mark.parametrize(
    ("heading", "name", "unit"),
    [
        ("Angle/rad", "Angle", "rad"),
        ("AngVel/rad/s", "AngVel", "rad/s"),
        ("phase/A", "phase/A", ""),  # a phase, not a current
        ("pose/position/x", "pose/position/x", ""),
    ],
)
def test_a_quantity_over_its_unit_needs_no_blanks(heading, name, unit):
    assert cell.heading(heading) == (name, unit)


def test_a_stamp_in_brackets_has_its_unit_and_the_values_a_name_each(tmp_path):
    path = tmp_path / "first.txt"
    path.write_text("\n" + rows("[{ms} ms] ypr: -7.4 {w} 3.8"))
    (stream,) = importers.read(path, importers.recognise(path), mapping.NOTHING).streams
    assert (stream.time, stream.column("time").unit) == ("time", "ms")
    assert [c.name for c in stream.columns] == ["time", "value 1", "value 2", "value 3"]
    assert stream.column("value 3").values[7] == 3.8


def test_words_behind_a_stamp_are_no_header(tmp_path):
    path = tmp_path / "scale.txt"
    path.write_text("09:41:06, HX711 demo\n09:41:06, Readings:\n" + rows("09:41:07.{h}0, 0.5"))
    (stream,) = importers.read(path, "csv", mapping.NOTHING).streams
    assert (len(stream), stream.column("column_2").values[0]) == (40, 0.5)


def test_what_a_terminal_writes_above_its_log_is_a_remark(tmp_path):
    path = tmp_path / "putty.log"
    path.write_text("=~=~=~= PuTTY log 2022.12.05 19:00:24 =~=~=~=\n" + rows("{t}  -18.3"))
    (stream,) = importers.read(path, "csv", mapping.NOTHING).streams
    assert (len(stream.columns), len(stream)) == (2, 40)


def test_a_log_that_begins_within_a_row_has_no_header(tmp_path):
    path = tmp_path / "bench.txt"
    path.write_text("-0.5.50 ,C\n" + rows("{t},N,23.86,V,35.5,C"))
    (stream,) = importers.read(path, "csv", mapping.NOTHING).streams
    assert (len(stream.columns), len(stream)) == (3, 40)


def test_a_source_with_usual_names_is_known_only_where_all_of_them_are_its_own():
    of_a_phone = [("timestamp", ""), ("AccX", ""), ("AccY", "")]
    assert profiles.find("log.csv", (), of_a_phone).title.startswith("Science Journal")
    assert profiles.find("log.csv", (), [*of_a_phone, ("AngX", "")]) is None


def test_a_level_that_a_logic_analyser_does_not_know_is_missing(tmp_path):
    path = tmp_path / "bus.csv"
    path.write_text("Time [s],Channel 0,Channel 1\n" + rows("{t},1,0") + "0.4,X,1\n")
    (stream,) = importers.read(path, "csv", mapping.NOTHING).streams
    assert np.isnan(stream.column("Channel 0").values[-1])


def test_header_stamps_that_go_back_are_no_clock(tmp_path):
    path = tmp_path / "odom.csv"
    lines = [
        f"{10**9 * n},{10**9 * (n - 3 * (n == 20))},{n}" for n in range(1700000000, 1700000040)
    ]
    lines[20] = lines[20].replace(",1700000020", ",1700000010")
    path.write_text("%time,field.header.stamp,field.x\n" + "\n".join(lines) + "\n")
    log = importers.read(path, "csv", mapping.NOTHING)
    assert log.streams[0].time == "%time"
    assert "go back once" in str(log.repairs)
