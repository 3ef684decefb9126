"""Compiler of kernels: reads their text, infers types, writes LLVM IR, compiles it to machine code and calls it.

It compiles a small part of Python: floats, integers, truth values, and arrays that the caller owns; `if`, `while`, `for
… in range`; calls of other kernels and of `math`. The same text also runs as plain Python, which is the reference.
"""
