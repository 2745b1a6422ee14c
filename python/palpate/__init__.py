"""Palpate: press a soft organ and feel it, from Python.

>>> import palpate
>>> session = palpate.Session(palpate.scene_path("stomach_probe"))
>>> touch = session.run(2.0, keep=["probe_state", "haptic_force"])

Scene: what is simulated, key by key. Session: a session in this process. connect(): a session of other processes.
read(): a recording. mesh: surfaces. All numbers are in SI units; docs/python.md shows how it goes together.
"""

from palpate import mesh
from palpate._core import __version__
from palpate.errors import BusyError, ClosedError, Error, InputError, SceneError
from palpate.live import Live, connect
from palpate.messages import Message, Ragged, Topic, Topics
from palpate.recording import Recording, read
from palpate.scene import Scene, scene_path
from palpate.session import Session

__all__ = [
    "BusyError",
    "ClosedError",
    "Error",
    "InputError",
    "Live",
    "Message",
    "Ragged",
    "Recording",
    "Scene",
    "SceneError",
    "Session",
    "Topic",
    "Topics",
    "__version__",
    "connect",
    "mesh",
    "read",
    "scene_path",
]
