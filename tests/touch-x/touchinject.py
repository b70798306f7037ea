#!/usr/bin/env python3
"""Inject REAL multi-touch (and pointer / key) events into a headless Xorg via its
`inputtest` driver (see with-touch-x.sh). Python 3.8+, stdlib only.

The events go through the whole X server (device -> XI2.2 TouchBegin/Update/End), so a
winit application receives ordinary WindowEvent::Touch with one id per contact.

  touchinject.py ten   [--hz 120] [--seconds 2] [--width 1280 --height 720]
  touchinject.py play  FILE|-      JSON lines, e.g. {"t":0.10,"op":"down","id":3,"x":400,"y":300,"pressure":0.5}
                                   op: down | move | up | key | button | pointer | start | sync | sleep
  touchinject.py key KEYCODE       press + release (X keycode = evdev + 8; Escape = 9)

x and y are screen pixels (floats; the axis has 65536 steps). t is seconds since the start, or since the last
"start" line. "sync" waits until the X server has processed everything before it, then prints "synced": a test that
writes lines to `play -` knows from it that they have arrived.
"""
import argparse, json, math, os, socket, struct, subprocess, sys, time

VERSION = (1, 1)
CLIENT_VERSION, WAIT_FOR_SYNC, MOTION, PROXIMITY, BUTTON, KEY, TOUCH = range(7)
XI_TouchBegin, XI_TouchUpdate, XI_TouchEnd = 18, 19, 20
AXIS_MAX, PRESSURE_MAX = 65535.0, 2047.0
MAX_VALUATORS = 64


def valuators(axes):
    """xf86ITValuatorData: u32 has_unaccelerated, u8 mask[8], (pad 4), f64[64], f64[64]."""
    mask, vals = bytearray(8), [0.0] * MAX_VALUATORS
    for i, v in axes.items():
        mask[i // 8] |= 1 << (i % 8)
        vals[i] = v
    return struct.pack("=I8s4x64d", 0, bytes(mask), *vals) + bytes(8 * MAX_VALUATORS)


class Device:
    """One connection to one inputtest device socket (the driver takes one client at a time)."""

    name = None  # X input device name in xorg-touch.conf.in

    def __init__(self, path):
        self.unsynced = False  # events were sent since the last sync
        self.s = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.s.connect(path)
        self._send(CLIENT_VERSION, struct.pack("=HH", *VERSION))
        # The driver takes ONE client per activation of the device, and does not notice one that
        # went away. If a previous client used it up, switch the device off and on; each round
        # frees one place in the accept queue, where hung-up clients may still be waiting.
        for attempt in range(8):
            self.s.settimeout(0.5)
            try:
                typ, body = self._recv()
                break
            except socket.timeout:
                if attempt == 0:
                    print(f"{path}: in use or used up; switching {self.name} off and on", file=sys.stderr)
                reset_device(self.name)
        else:
            sys.exit(f"{path}: the inputtest driver does not answer")
        assert typ == 0, "no server version"
        self.server_version = struct.unpack("=HH", body)
        self.s.settimeout(5)

    def _send(self, typ, body=b""):
        self.s.sendall(struct.pack("=II", 8 + len(body), typ) + body)

    def _event(self, typ, body):
        self._send(typ, body)
        self.unsynced = True

    def _recv(self):
        def exactly(n):
            b = b""
            while len(b) < n:
                c = self.s.recv(n - len(b))
                if not c:
                    raise ConnectionError("X server closed the inputtest socket")
                b += c
            return b
        n, typ = struct.unpack("=II", exactly(8))
        return typ, exactly(n - 8)

    def sync(self):
        """Returns when the X server has processed everything sent before. The driver answers only
        where there was something to process."""
        if self.unsynced:
            self._send(WAIT_FOR_SYNC)
            typ, _ = self._recv()
            assert typ == 1, "no sync response"
            self.unsynced = False

    def close(self):
        """Leave tidily. The driver does not notice a plain hang-up: it would spin at 100 % CPU
        on the dead socket. A second ClientVersion makes it drop the connection itself.
        Either way it takes the NEXT client only after the device was switched off and on, so
        prefer one connection per X server."""
        if self.s is None:
            return
        try:
            self.sync()
            self._send(CLIENT_VERSION, struct.pack("=HH", *VERSION))
            self.s.recv(1)
        except OSError:
            pass
        self.s.close()
        self.s = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def reset_device(name):
    """Switch an X input device off and on (like re-plugging it): needs `xinput` and DISPLAY.
    Afterwards its socket takes a new client."""
    for op in ("disable", "enable"):
        subprocess.run(["xinput", op, name], check=True)


class Touch(Device):
    name = "touch0"

    def __init__(self, path, width, height):
        super().__init__(path)
        self.w, self.h = width, height

    def _touch(self, ident, kind, x, y, pressure):
        # The server maps axis value v to pixel v * size / 65536 (range 0..65535 inclusive).
        axes = {0: x * (AXIS_MAX + 1) / self.w, 1: y * (AXIS_MAX + 1) / self.h}
        if pressure is not None:
            axes[4] = pressure * PRESSURE_MAX
        self._event(TOUCH, struct.pack("=II", ident, kind) + valuators(axes))

    def down(self, ident, x, y, pressure=None):
        self._touch(ident, XI_TouchBegin, x, y, pressure)

    def move(self, ident, x, y, pressure=None):
        self._touch(ident, XI_TouchUpdate, x, y, pressure)

    def up(self, ident, x, y):
        self._touch(ident, XI_TouchEnd, x, y, None)


class Keyboard(Device):
    name = "kbd0"

    def key(self, keycode, press):
        self._event(KEY, struct.pack("=iI", keycode, 1 if press else 0))

    def tap(self, keycode):
        self.key(keycode, True)
        self.key(keycode, False)


class Pointer(Device):
    name = "ptr0"

    def __init__(self, path, width, height):
        super().__init__(path)
        self.w, self.h = width, height

    def _axes(self, x, y):
        return valuators({0: x * (AXIS_MAX + 1) / self.w, 1: y * (AXIS_MAX + 1) / self.h})

    def move(self, x, y):
        # 8-byte header + u32 is_absolute, then 4 bytes of padding before the 8-aligned valuators.
        self._event(MOTION, struct.pack("=I4x", 1) + self._axes(x, y))

    def button(self, n, press):
        # i32 is_absolute, i32 button, u32 is_press, 4 pad, valuators (empty mask).
        self._event(BUTTON, struct.pack("=iiI4x", 1, n, 1 if press else 0) + valuators({}))


def ten_fingers(t, w, h):
    """Two hands, five fingers each, each hand turning and opening; returns {id: (x, y)}."""
    out = {}
    for hand, (cx, cy, sgn) in enumerate([(0.3, 0.55, 1.0), (0.7, 0.55, -1.0)]):
        for f in range(5):
            a = sgn * (0.6 * t) + math.pi + f * math.pi / 5
            r = (0.14 + 0.05 * math.sin(2.2 * t)) * h
            out[hand * 5 + f] = (cx * w + r * math.cos(a), cy * h + r * math.sin(a))
    return out


def run_ten(dev, hz, seconds, w, h):
    start = ten_fingers(0.0, w, h)
    for i, (x, y) in start.items():
        dev.down(i, x, y, 0.5)
    dev.sync()
    t0, n, late, sent = time.monotonic(), max(1, round(hz * seconds)), 0.0, 0
    for k in range(1, n + 1):
        due = t0 + k / hz
        d = due - time.monotonic()
        if d > 0:
            time.sleep(d)
        late = max(late, time.monotonic() - due)
        for i, (x, y) in ten_fingers(k / hz, w, h).items():
            dev.move(i, x, y, 0.5)
            sent += 1
    dev.sync()
    for i, (x, y) in ten_fingers(n / hz, w, h).items():
        dev.up(i, x, y)
    dev.sync()
    took = time.monotonic() - t0
    print(f"sent 10 down, {sent} move ({n} frames of 10 at {n / took:.1f} Hz), 10 up; worst lateness {late * 1e3:.1f} ms")


def run_play(a):
    src = sys.stdin if a.file == "-" else open(a.file)
    dev = Touch(a.touch, a.width, a.height)
    kbd = ptr = None
    last, t0 = {}, time.monotonic()
    for line in src:
        line = line.strip()
        if not line or line.startswith("#"):
            continue
        e = json.loads(line)
        if "t" in e:
            d = t0 + float(e["t"]) - time.monotonic()
            if d > 0:
                time.sleep(d)
        op, i = e["op"], int(e.get("id", 0))
        if op in ("down", "move"):
            last[i] = (e["x"], e["y"])
            getattr(dev, op)(i, e["x"], e["y"], e.get("pressure"))
        elif op == "up":
            x, y = last.pop(i, (0, 0))
            dev.up(i, e.get("x", x), e.get("y", y))
        elif op == "key":
            kbd = kbd or Keyboard(a.keyboard)
            if "press" in e:
                kbd.key(int(e["code"]), bool(e["press"]))
            else:
                kbd.tap(int(e["code"]))
        elif op == "pointer":
            ptr = ptr or Pointer(a.pointer, a.width, a.height)
            ptr.move(e["x"], e["y"])
        elif op == "button":
            ptr = ptr or Pointer(a.pointer, a.width, a.height)
            ptr.button(int(e.get("button", 1)), bool(e["press"]))
        elif op == "start":
            t0 = time.monotonic()
        elif op == "sync":
            for d in (dev, kbd, ptr):
                if d:
                    d.sync()
            print("synced", flush=True)
        elif op == "sleep":
            time.sleep(float(e["s"]))
        else:
            sys.exit(f"unknown op {op!r}")
    for d in (dev, kbd, ptr):
        if d:
            d.close()


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--touch", default=os.environ.get("TOUCH_SOCK"))
    p.add_argument("--pointer", default=os.environ.get("PTR_SOCK"))
    p.add_argument("--keyboard", default=os.environ.get("KBD_SOCK"))
    p.add_argument("--width", type=float, default=os.environ.get("TOUCH_W", "1280"))
    p.add_argument("--height", type=float, default=os.environ.get("TOUCH_H", "720"))
    sub = p.add_subparsers(dest="cmd", required=True)
    t = sub.add_parser("ten")
    t.add_argument("--hz", type=float, default=120)
    t.add_argument("--seconds", type=float, default=2)
    t = sub.add_parser("play")
    t.add_argument("file")
    t = sub.add_parser("key")
    t.add_argument("code", type=int)
    a = p.parse_args()
    if a.cmd == "ten":
        with Touch(a.touch, a.width, a.height) as dev:
            run_ten(dev, a.hz, a.seconds, a.width, a.height)
    elif a.cmd == "play":
        run_play(a)
    else:
        with Keyboard(a.keyboard) as k:
            k.tap(a.code)


if __name__ == "__main__":
    main()
