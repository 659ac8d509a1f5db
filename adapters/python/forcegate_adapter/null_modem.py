"""Two serial ports that are connected with each other, made of pseudo terminals: one end for a program under test, the
other for the instrument that somebody plays with pyserial."""

import os
import select
import threading
import tty


class NullModem:
    def __init__(self):
        self.masters, self.keepers, self.ports = [], [], []
        for _ in range(2):
            master, slave = os.openpty()
            tty.setraw(slave)
            self.masters.append(master)
            self.keepers.append(slave)  # an open end keeps the terminal alive between two programs
            self.ports.append(os.ttyname(slave))
        self.wake, self.waker = os.pipe()
        self.thread = threading.Thread(target=self._carry, daemon=True)
        self.thread.start()

    def _carry(self):
        a, b = self.masters
        while True:
            ready, _, _ = select.select([a, b, self.wake], [], [])
            if self.wake in ready:
                return
            for end in ready:
                data = os.read(end, 4096)
                os.write(b if end == a else a, data)

    def close(self):
        os.write(self.waker, b"x")
        self.thread.join()
        for fd in self.masters + self.keepers + [self.wake, self.waker]:
            os.close(fd)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
