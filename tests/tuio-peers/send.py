"""Independent TUIO senders: `send.py KIND PORT` speaks to that port of this machine.

Prints a JSON list with what touches after each frame that a receiver should believe: a map from contact ids (the
profile of TUIO 1.1 above the session id: 0 cursors, 1 objects, 2 blobs) to places in parts of the surface.
"""

import json
import math
import sys
import time

from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.udp_client import UDPClient
from pythontuio import Blob, Cursor, Object, TuioServer

PAUSE_S = 0.008
truth = []


def believe(contacts):
    truth.append({str(id): list(place) for id, place in contacts.items()})
    time.sleep(PAUSE_S)


def circle(step, radius):
    angle = step / 10
    return (0.5 + radius * math.cos(angle), 0.5 + radius * math.sin(angle))


def message(address, *values):
    builder = OscMessageBuilder(address=address)
    for value in values:
        if isinstance(value, tuple):
            builder.add_arg(value[1], value[0])
        else:
            builder.add_arg(value)
    return builder.build()


def bundle(*messages):
    builder = OscBundleBuilder(IMMEDIATELY)
    for content in messages:
        builder.add_content(content)
    return builder.build()


def python_tuio(port):
    """TUIO 1.1 as python-tuio sends it: three profiles in a bundle, one number, which is -1, and no source."""
    server = TuioServer("127.0.0.1", port)

    def send():
        server.send_bundle()
        contacts = {cursor.session_id: cursor.position for cursor in server.cursors}
        contacts |= {1 << 32 | thing.session_id: thing.position for thing in server.objects}
        contacts |= {2 << 32 | blob.session_id: blob.position for blob in server.blobs}
        believe(contacts)

    send()
    server.cursors.append(Cursor(12))
    server.objects.append(Object(12))
    server.blobs.append(Blob(12))
    server.objects[0].position = (0.05, 0.05)
    server.blobs[0].position = (0.9, 0.9)
    for step in range(50):
        server.cursors[0].position = circle(step, 0.3)
        if step == 20:
            server.cursors.append(Cursor(13))
        if step == 30:
            server.objects.clear()
        send()
    server.cursors.pop(0)
    send()
    server.cursors = [Cursor(100 + i) for i in range(40)]
    for i, cursor in enumerate(server.cursors):
        cursor.position = (i / 40, 0.25)
    send()
    server.cursors.clear()
    server.blobs.clear()
    send()


def numbered(port):
    """TUIO 1.1 with source and numbers, frames in two bundles, late bundles, and a new start."""
    client = UDPClient("127.0.0.1", port)
    address = "/tuio/2Dcur"

    def send(number, contacts, placed=None):
        sets = [
            message(address, "set", id, x, y, 0.0, 0.0, 0.0)
            for id, (x, y) in contacts.items()
            if placed is None or id in placed
        ]
        source = message(address, "source", "peer@127.0.0.1")
        alive = message(address, "alive", *contacts)
        client.send(bundle(source, alive, *sets, message(address, "fseq", number)))

    for step in range(1, 40):
        contacts = {1: circle(step, 0.2), 2: circle(step, 0.4)}
        send(step, contacts, [1])
        # The second finger is where it was, or nowhere yet.
        believe({1: contacts[1]} | ({2: circle(step - 1, 0.4)} if step > 1 else {}))
        send(step, contacts, [2])
        believe(contacts)
    send(20, {9: (0.9, 0.9)})
    send(39, {})
    believe({})
    for step in range(501, 510):
        send(step, {3: circle(step, 0.1)})
        believe({3: circle(step, 0.1)})
    send(1, {3: (0.25, 0.75)})
    believe({3: (0.25, 0.75)})
    send(-1, {})
    believe({})


def second(port):
    """TUIO 2.0: pointers, tokens and outlines, frames in two bundles, late ones, ones without a number."""
    client = UDPClient("127.0.0.1", port)

    def frame(number):
        # python-osc writes no time tags as arguments; a long integer has the same bytes.
        now = ("h", int(time.time()) << 32)
        head = message("/tuio2/frm", number, now, 1920 << 16 | 1080, "peer:0@127.0.0.1")
        return OscMessage(head.dgram.replace(b",ihis", b",itis", 1))

    def pointer(id, place):
        return message("/tuio2/ptr", id, 0x00020005, 0, *map(float, place), 1.24, 0.0, 0.001, 0.5)

    def alive(*ids):
        return message("/tuio2/alv", *ids)

    token = message("/tuio2/tok", 5, 1, 82, 0.625, 0.75, 0.32)
    outline = message("/tuio2/bnd", 6, 0.125, 0.875, 0.64, 0.04, 0.03, 0.001)
    symbol = message("/tuio2/sym", 5, 1, 82, "ms/id", "0x50E1")
    for step in range(1, 40):
        one, two = circle(step, 0.2), circle(step, 0.4)
        client.send(bundle(frame(step), pointer(1, one), token, symbol))
        client.send(bundle(frame(step), pointer(2, two), outline, alive(1, 2, 5, 6)))
        believe({1: one, 2: two, 5: (0.625, 0.75), 6: (0.125, 0.875)})
    client.send(bundle(frame(20), pointer(9, (0.9, 0.9)), alive(9)))
    client.send(bundle(frame(40), alive(2)))
    believe({2: circle(39, 0.4)})
    client.send(bundle(frame(0), pointer(2, (0.5, 0.5)), alive(2)))
    believe({2: (0.5, 0.5)})
    many = {100 + i: (i / 40, 0.25) for i in range(40)}
    client.send(bundle(frame(41), *[pointer(id, place) for id, place in many.items()], alive(*many)))
    believe(many)
    client.send(bundle(frame(42), alive()))
    believe({})


if __name__ == "__main__":
    kind, port = sys.argv[1], int(sys.argv[2])
    {"python-tuio": python_tuio, "numbered": numbered, "second": second}[kind](port)
    json.dump(truth, sys.stdout)
