#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#
# usage: rtde_client.py PORT RATE_HZ
#
# A second client of RTDE, written from the protocol's table alone and sharing nothing with Glint's
# own: handshake, version, recipes, types, rates, pause, NOT_FOUND, IN_USE, split and glued messages,
# two clients at once. Exit 0 when the controller at 127.0.0.1:PORT does all of it right.
import socket
import struct
import sys
import time

PORT, RATE = int(sys.argv[1]), float(sys.argv[2])
FORMATS = {
    "BOOL": "?", "UINT8": "B", "UINT32": "I", "UINT64": "Q", "INT32": "i", "DOUBLE": "d",
    "VECTOR3D": "3d", "VECTOR6D": "6d", "VECTOR6INT32": "6i", "VECTOR6UINT32": "6I",
}
WANTED = [
    ("timestamp", "DOUBLE"), ("target_q", "VECTOR6D"), ("actual_q", "VECTOR6D"),
    ("actual_qd", "VECTOR6D"), ("actual_TCP_pose", "VECTOR6D"), ("actual_TCP_speed", "VECTOR6D"),
    ("robot_mode", "INT32"), ("safety_mode", "INT32"), ("safety_status_bits", "UINT32"),
    ("robot_status_bits", "UINT32"), ("runtime_state", "UINT32"), ("speed_scaling", "DOUBLE"),
    ("actual_digital_output_bits", "UINT64"), ("output_int_register_3", "INT32"),
]


def expect(holds, what):
    if not holds:
        sys.exit(f"rtde_client: {what}")


class Client:
    def __init__(self, read_bytes=65536):
        self.socket = socket.create_connection(("127.0.0.1", PORT), timeout=3)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.read_bytes = read_bytes
        self.buffer = b""

    def send(self, kind, payload=b"", piece=None):
        frame = struct.pack(">HB", len(payload) + 3, ord(kind)) + payload
        for i in range(0, len(frame), piece or len(frame)):
            self.socket.sendall(frame[i:i + (piece or len(frame))])

    def frame(self):
        while len(self.buffer) < 2 or len(self.buffer) < struct.unpack(">H", self.buffer[:2])[0]:
            more = self.socket.recv(self.read_bytes)
            expect(more, "the controller closed the connection")
            self.buffer += more
        size = struct.unpack(">H", self.buffer[:2])[0]
        frame, self.buffer = self.buffer[:size], self.buffer[size:]
        return chr(frame[2]), frame[3:]

    def reply(self, kind):
        while True:
            got, payload = self.frame()
            if got == kind:
                return payload
            expect(got in "MU", f"a package {got}, expected {kind}")

    def handshake(self):
        self.send("V", struct.pack(">H", 2))
        expect(self.reply("V") == b"\x01", "version 2 is not accepted")
        self.send("v")
        version = struct.unpack(">4I", self.reply("v"))
        expect(version[0] in (3, 5), f"controller version {version}")
        return version

    def recipe(self, kind, names, rate=None):
        head = b"" if rate is None else struct.pack(">d", rate)
        self.send(kind, head + ",".join(names).encode())
        payload = self.reply(kind)
        return payload[0], payload[1:].decode().split(",")

    def start(self):
        self.send("S")
        return self.reply("S") == b"\x01"

    def pause(self):
        self.send("P")
        return self.reply("P") == b"\x01"

    def data(self, recipe, types):
        payload = self.reply("U")
        expect(payload[0] == recipe, f"data of recipe {payload[0]}, asked was for {recipe}")
        form = ">" + "".join(FORMATS[name] for name in types)
        expect(len(payload) - 1 == struct.calcsize(form), "data of another length")
        return struct.unpack(form, payload[1:])


def check_values_and_rate():
    client = Client()
    version = client.handshake()
    expect((500.0 if version[0] == 5 else 125.0) == RATE, "another generation")
    recipe, types = client.recipe("O", [name for name, _ in WANTED], RATE)
    expect(types == [kind for _, kind in WANTED], f"types are {types}")
    expect(client.start(), "does not start")
    stamps = [client.data(recipe, types)[0] for _ in range(50)]
    steps = [b - a for a, b in zip(stamps, stamps[1:])]
    expect(all(abs(step - 1 / RATE) < 1e-9 for step in steps), f"steps of the stamps: {steps}")
    values = client.data(recipe, types)
    scalars = dict(zip(["robot_mode", "safety_mode"], values[31:33]))
    expect(scalars == {"robot_mode": 7, "safety_mode": 1}, f"modes are {scalars}")
    expect(client.pause(), "does not pause")
    client.socket.settimeout(0.2)
    try:
        client.buffer = b""
        client.socket.recv(65536)
        expect(False, "sends data after it has paused")
    except socket.timeout:
        pass
    client.socket.settimeout(3)
    recipe, types = client.recipe("O", ["timestamp"], RATE / 5)
    expect(client.start(), "does not start again")
    stamps = [client.data(recipe, types)[0] for _ in range(10)]
    expect(all(abs(b - a - 5 / RATE) < 1e-9 for a, b in zip(stamps, stamps[1:])), "a fifth of the rate")


def check_refusals():
    client = Client()
    client.send("V", struct.pack(">H", 9))
    expect(client.reply("V") == b"\x00", "version 9 is accepted")
    client.handshake()
    expect(not client.start(), "starts without a recipe")
    _, types = client.recipe("O", ["timestamp", "nothing_of_that_name"], RATE)
    expect(types == ["DOUBLE", "NOT_FOUND"], f"types are {types}")
    expect(not client.start(), "starts with an output that it does not know")
    _, types = client.recipe("I", ["nothing_of_that_name"])
    expect(types == ["NOT_FOUND"], f"types of inputs are {types}")


def check_inputs():
    first, second = Client(), Client()
    first.handshake()
    second.handshake()
    names = ["standard_digital_output_mask", "standard_digital_output"]
    recipe, types = first.recipe("I", names)
    expect(types == ["UINT8", "UINT8"], f"types of inputs are {types}")
    _, taken = second.recipe("I", names)
    expect(taken == ["IN_USE", "IN_USE"], f"a second client is told {taken}")
    first.send("U", struct.pack(">BBB", recipe, 0b101, 0b001))
    outputs, kinds = second.recipe("O", ["actual_digital_output_bits"], RATE)
    expect(second.start(), "does not start")
    deadline = time.time() + 2
    while second.data(outputs, kinds)[0] != 1:
        expect(time.time() < deadline, "the digital output does not follow its input")
    first.socket.close()
    time.sleep(0.1)
    _, free = second.recipe("I", names)
    expect(free == ["UINT8", "UINT8"], "inputs are not given back")


def check_split_and_glued():
    split = Client(read_bytes=1)
    split.send("V", struct.pack(">H", 2), piece=1)
    expect(split.reply("V") == b"\x01", "a request in pieces is not understood")
    glued = Client()
    request = struct.pack(">HBH", 5, ord("V"), 2) + struct.pack(">HB", 3, ord("v"))
    glued.socket.sendall(request)
    expect(glued.reply("V") == b"\x01" and len(glued.reply("v")) == 16, "glued requests")
    recipe, types = split.recipe("O", ["timestamp"], 25.0)
    expect(split.start() and split.data(recipe, types)[0] >= 0, "data byte by byte")


check_values_and_rate()
check_refusals()
check_inputs()
check_split_and_glued()
print("rtde_client: all as the protocol says")
