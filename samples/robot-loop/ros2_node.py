"""A node of ROS 2 that keeps a model alive: hand (PointStamped [m]) in, force (WrenchStamped [N]) out, at 1 kHz.

    python3 ros2_node.py --ros-args -p model:=model.json

Positions are in the frame of the model. Written after rclpy's documentation, and not run.
"""

import palpate
import rclpy
from geometry_msgs.msg import PointStamped, WrenchStamped
from rclpy.node import Node


class PalpateNode(Node):
    def __init__(self):
        super().__init__("palpate")
        self._body = palpate.Body(self.declare_parameter("model", "model.json").value, damping_ratio=0.5)
        self._contact, self._felt = None, WrenchStamped()
        self._forces = self.create_publisher(WrenchStamped, "force", 1)
        self.create_subscription(PointStamped, "hand", self._drag, 1)
        self.create_timer(1e-3, self._step)

    def _drag(self, message):
        place = [1000 * x for x in (message.point.x, message.point.y, message.point.z)]  # [mm]
        if self._contact is None:
            self._contact, self._felt.header.frame_id = self._body.touch(place, 2.0), message.header.frame_id
        self._body.drag(self._contact, place, 0.5)

    def _step(self):
        self._body.step(1e-3)
        if self._contact is not None:
            force = self._felt.wrench.force
            force.x, force.y, force.z = (-self._body.force(self._contact)).tolist()
            self._felt.header.stamp = self.get_clock().now().to_msg()
            self._forces.publish(self._felt)


rclpy.init()
rclpy.spin(PalpateNode())
