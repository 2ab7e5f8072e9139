"""A client of `photorque serve`: it receives measurements and sends commands over UDP.

Needs only the standard library; the file can be used without the rest of the package. The packet layout is
that of photorque_serve.h.

    with Client() as client:                            # 127.0.0.1:4160
        for measurement in client.measurements():
            client.command([0.0, 0.0, -1e-4 * measurement.gyro_rad_s[2]])

In lockstep every measurement with `wants_answer` must be answered by one command.
"""

import socket
import struct
import time
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import TracebackType

MAGIC = 0x51525450
VERSION = 1
HELLO, COMMAND, MEASUREMENT, GOODBYE = 1, 2, 3, 4
NEW, ANSWER, LATE, LAST, TRUTH = 1, 2, 4, 8, 16

_HEADER = struct.Struct("<IHHIIQQQQ")
_COMMAND = struct.Struct("<3d")
_MEASUREMENT = struct.Struct("<3Qd4d3d3d3d4d3dd2I")
_SIZE = _HEADER.size + _MEASUREMENT.size
_CHECKSUM_AT = 12


@dataclass(frozen=True)
class Measurement:
    """One packet of the server; NaN if an instrument has no reading at this tick."""

    tick: int  # tick of the reading
    now_tick: int  # tick of the arrival
    t_s: float
    attitude: tuple[float, ...]  # of the camera: w, x, y, z, lab from body
    gyro_rad_s: tuple[float, ...]  # body axes
    yaw_rad: float  # azimuth of body x from the encoder
    battery_current_A: float
    array_power_W: float
    command_body_N_m: tuple[float, ...]  # torque applied until this tick
    command_sequence: int  # of the acting command; 0: none yet
    command_sent_ns: int  # sent_ns of that command, by this machine's monotonic clock
    true_attitude: tuple[float, ...]  # zero unless serve.send_truth
    true_rate_rad_s: tuple[float, ...]
    step_s: float
    is_new: bool
    wants_answer: bool
    is_late: bool
    is_last: bool
    refused: int  # number of rejected packets so far, of all senders
    sequence: int
    sent_ns: int


def seal(kind: int, sequence: int, tick: int, run: int, body: bytes = b"") -> bytes:
    """A packet with its checksum."""
    head = [MAGIC, VERSION, kind, _HEADER.size + len(body), 0, sequence, time.monotonic_ns(), tick, run]
    head[4] = zlib.crc32(_HEADER.pack(*head) + body)
    return _HEADER.pack(*head) + body


def unseal(packet: bytes) -> tuple[int, Measurement] | None:
    """(run, Measurement) of a server's packet; None for other packets."""
    if len(packet) != _SIZE:
        return None
    magic, version, kind, size, checksum, sequence, sent_ns, tick, run = _HEADER.unpack_from(packet)
    if (magic, version, kind, size) != (MAGIC, VERSION, MEASUREMENT, _SIZE):
        return None
    blank = packet[:_CHECKSUM_AT] + bytes(4) + packet[_CHECKSUM_AT + 4:]
    if zlib.crc32(blank) != checksum:
        return None
    v = _MEASUREMENT.unpack_from(packet, _HEADER.size)
    flags = v[25]
    return run, Measurement(
        tick=tick, now_tick=v[0], t_s=v[3], attitude=v[4:8], gyro_rad_s=v[8:11], yaw_rad=v[11],
        battery_current_A=v[12], array_power_W=v[13], command_body_N_m=v[14:17],
        command_sequence=v[1], command_sent_ns=v[2], true_attitude=v[17:21],
        true_rate_rad_s=v[21:24], step_s=v[24], is_new=bool(flags & NEW),
        wants_answer=bool(flags & ANSWER), is_late=bool(flags & LATE), is_last=bool(flags & LAST),
        refused=v[26], sequence=sequence, sent_ns=sent_ns)


class Client:
    """Connects to a run."""

    def __init__(
        self,
        address: str = "127.0.0.1",
        port: int = 4160,
        timeout_s: float = 10.0,
    ) -> None:
        self._socket: socket.socket | None = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect((address, port))
        self._timeout_s = timeout_s
        self._sequence = 0
        self._run = 0
        self._tick = 0
        self._last_sequence = 0
        self._last_command: bytes | None = None

    def _open(self) -> socket.socket:
        if self._socket is None:
            raise ValueError("the client is closed")
        return self._socket

    def _put(self, packet: bytes) -> None:
        try:
            self._open().send(packet)
        except ConnectionRefusedError:
            pass  # no server is listening

    def _send(self, kind: int, body: bytes = b"") -> bytes:
        self._sequence += 1
        packet = seal(kind, self._sequence, self._tick, self._run, body)
        self._put(packet)
        return packet

    def receive(self) -> Measurement | None:
        """The next measurement; None if none arrives within timeout_s. Sends hello until the first one."""
        end = time.monotonic() + self._timeout_s
        while time.monotonic() < end:
            if self._run == 0:
                self._send(HELLO)
            self._open().settimeout(min(0.2, self._timeout_s))
            try:
                found = unseal(self._open().recv(2048))
            except (TimeoutError, ConnectionRefusedError):
                continue
            if not found or (self._run and found[0] != self._run):
                continue
            self._run, measurement = found
            if measurement.sequence <= self._last_sequence:
                # Repeated in lockstep, perhaps because the answer was lost.
                if measurement.sequence == self._last_sequence and self._last_command:
                    self._put(self._last_command)
                continue
            self._last_sequence = measurement.sequence
            self._last_command = None
            self._tick = measurement.now_tick
            return measurement
        return None

    def measurements(self) -> Iterator[Measurement]:
        """All measurements until the run ends or is silent for timeout_s."""
        while (measurement := self.receive()) is not None:
            if measurement.is_last:
                return
            yield measurement

    def command(self, torque_body_N_m: Sequence[float]) -> None:
        """Sets the torque about the body axes [N m], which acts until the next command."""
        self._last_command = self._send(COMMAND, _COMMAND.pack(*torque_body_N_m))

    def close(self) -> None:
        """Leaves the run, which continues without commands."""
        if self._socket is None:
            return
        if self._run:
            self._send(GOODBYE)
        self._socket.close()
        self._socket = None

    def __enter__(self) -> "Client":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
