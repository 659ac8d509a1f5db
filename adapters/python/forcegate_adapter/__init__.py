"""Adapters of a Forcegate bench in Python, on pyserial.

An adapter is one class and one call:

    from forcegate_adapter import Reading, ReferenceAdapter, serve

    class Scale(ReferenceAdapter):
        def open(self, port, options, exclusive): ...

    if __name__ == "__main__":
        serve(Scale())

docs/adapters.md tells the whole of it.
"""

from .base import Adapter, AdapterError, BoardAdapter, MotorAdapter, Reading, ReferenceAdapter, Sample, check_options, serve
from .ports import find_ports, open_port

__all__ = ["Adapter", "AdapterError", "BoardAdapter", "MotorAdapter", "Reading", "ReferenceAdapter", "Sample", "check_options",
           "find_ports", "open_port", "serve"]
