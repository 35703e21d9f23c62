"""A ROS 2 node that keeps a model alive: /hand (PointStamped [m]) in, /force (WrenchStamped [N]) out, at 1 kHz.

    python3 ros2_node.py --ros-args -p model:=model.json          # after `source /opt/ros/<distribution>/setup.bash`

Positions are in the frame of the model. It has been written by rclpy's documentation and not been run.
"""

import palpate
import rclpy
from geometry_msgs.msg import PointStamped, WrenchStamped
from rclpy.node import Node


class PalpateNode(Node):
    def __init__(self):
        super().__init__("palpate")
        self._body = palpate.Body(self.declare_parameter("model", "model.json").value, damping_ratio=0.5)
        self._contact = None
        self._forces = self.create_publisher(WrenchStamped, "force", 1)
        self.create_subscription(PointStamped, "hand", self._drag, 1)
        self.create_timer(1e-3, self._step)

    def _drag(self, message):
        point = [1000.0 * x for x in (message.point.x, message.point.y, message.point.z)]  # m to mm
        if self._contact is None:
            self._contact = self._body.touch(point, 2.0)
        self._body.drag(self._contact, point, 0.5)
        self._frame = message.header.frame_id

    def _step(self):
        self._body.step(1e-3)
        if self._contact is None:
            return
        felt = WrenchStamped()
        felt.header.stamp, felt.header.frame_id = self.get_clock().now().to_msg(), self._frame
        felt.wrench.force.x, felt.wrench.force.y, felt.wrench.force.z = map(float, -self._body.force(self._contact))
        self._forces.publish(felt)


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(PalpateNode())
