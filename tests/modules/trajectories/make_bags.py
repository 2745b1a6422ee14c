#!/usr/bin/env python3
"""Writes the bags that ros_bag_test.cpp reads, with ROS's own rosbag (Debian: python3-rosbag, python3-geometry-msgs).

    /usr/bin/python3 make_bags.py FOLDER
"""
import sys
from pathlib import Path

import genpy
import rosbag
from geometry_msgs.msg import PointStamped, PoseStamped, TransformStamped, Twist

ROWS = 50


def stamp(i):
    return genpy.Time(1700000000, 995000000) + genpy.Duration(0, i * 10000000)


def pose(i):
    message = PoseStamped()
    message.header.stamp, message.header.frame_id, message.header.seq = stamp(i), "base", i
    p, q = message.pose.position, message.pose.orientation
    p.x, p.y, p.z = 0.001 * i, -0.5, 0.25
    q.x, q.y, q.z, q.w = 0.6, 0.0, 0.0, 0.8
    return message


def transform(i):
    message = TransformStamped()
    message.header.stamp, message.header.frame_id, message.child_frame_id = stamp(i), "base", "tool_tip"
    t, q = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = 0.002 * i, -0.5, 0.25
    q.x, q.y, q.z, q.w = 0.0, 0.6, 0.0, 0.8
    return message


def point(i):
    message = PointStamped()
    message.header.stamp = stamp(i)
    message.point.x = 0.003 * i
    return message


def write(file, topics, compression):
    with rosbag.Bag(str(file), "w", compression=compression, chunk_threshold=4096) as bag:
        for i in range(ROWS):
            for topic, make in topics.items():
                bag.write(topic, make(i), stamp(i))


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    many = {"/tool/pose": pose, "/tool/tf": transform, "/tool/point": point, "/tool/twist": lambda i: Twist()}
    write(folder / "topics.bag", many, rosbag.Compression.NONE)
    write(folder / "one.bag", {"/tool/pose": pose, "/tool/twist": lambda i: Twist()}, rosbag.Compression.NONE)
    write(folder / "bz2.bag", {"/tool/pose": pose}, rosbag.Compression.BZ2)


main()
