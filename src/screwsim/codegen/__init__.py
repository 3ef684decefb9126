"""From the text of kernels to machine code: read, given types, written as LLVM's language, compiled, called.

What is compiled is a small part of Python: floats, integers, truth values and arrays that the caller owns; `if`,
`while`, `for … in range`; calls of other kernels and of `math`. The text runs as plain Python, too, which is its
reference.
"""
