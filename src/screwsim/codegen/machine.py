"""Machine code from LLVM IR: optimised for this processor and loaded into this process."""

import ctypes
import threading
from functools import cache
from typing import Any

import llvmlite.binding as llvm

PASSES, CODE = 1, 3  # LLVM levels 0 to 3 of passes and code: more passes take twice the time for no faster code
SOON = 0  # level of quickly compiled code: a fifth of the compile time, two to three times as slow
_alone = threading.RLock()
_own = threading.local()  # targets of each thread


def _target(level: int = CODE) -> llvm.TargetMachine:
    """Return this thread's target machine for this processor and a level of code."""
    targets = _own.__dict__.setdefault("targets", {})
    if level not in targets:
        with _alone:
            llvm.initialize_native_target()
            llvm.initialize_native_asmprinter()
            features = llvm.get_host_cpu_features().flatten()
            target = llvm.Target.from_triple(llvm.get_process_triple())
            targets[level] = target.create_target_machine(
                cpu=llvm.get_host_cpu_name(), features=features, opt=level, codemodel="jitdefault", jit=True
            )
    return targets[level]


def processor() -> str:
    """Return what machine code depends on: LLVM's version and this processor."""
    features = llvm.get_host_cpu_features().flatten()
    return f"{llvm.llvm_version_info} {llvm.get_process_triple()} {llvm.get_host_cpu_name()} {features}"


def compiled(text: str, fast: bool = False) -> bytes:
    """Return the object code of a text: compiled quickly, or `fast` to run, which takes five times as long to compile.

    No pass may change a bit of a result: both give the same.
    """
    machine = _target(CODE if fast else SOON)
    module = llvm.parse_assembly(text, llvm.create_context())
    module.triple = llvm.get_process_triple()
    module.data_layout = str(machine.target_data)
    tuning = llvm.create_pipeline_tuning_options(speed_level=PASSES)
    tuning.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, tuning)
    if fast:
        passes = builder.getModulePassManager()
    else:  # only variables into registers
        passes = llvm.create_new_module_pass_manager()
        passes.add_sroa_pass()
        passes.add_simplify_cfg_pass()
    passes.run(module, builder)
    return machine.emit_object(module)


@cache
def _linker() -> Any:
    return llvm.create_lljit_compiler(_target())


_kept: list[Any] = []  # objects that must live as long as their code
CALL = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)


def loaded(code: bytes, symbol: str) -> Any:
    """Return the entry of object code, to be called with the addresses of arguments and results."""
    library = llvm.JITLibraryBuilder().add_object_img(code).add_current_process().export_symbol(symbol)
    with _alone:
        tracker = library.link(_linker(), f"{symbol} {len(_kept)}")  # a unique name
        _kept.append(tracker)
    return CALL(tracker[symbol])


DEVICE, FEATURES = "sm_75", "+ptx78"  # oldest architecture supported: the driver translates the PTX for its device
DEVICE_PASSES = 2  # keeps the PTX small, and the driver's part of compiling short


def for_device(text: str) -> str:
    """Return the PTX of a text, without fused multiply-adds."""
    with _alone:
        llvm.initialize_all_targets()
        llvm.initialize_all_asmprinters()
    target = llvm.Target.from_triple("nvptx64-nvidia-cuda")
    machine = target.create_target_machine(cpu=DEVICE, features=FEATURES, opt=CODE)
    module = llvm.parse_assembly(text, llvm.create_context())
    module.triple = "nvptx64-nvidia-cuda"
    module.data_layout = str(machine.target_data)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=DEVICE_PASSES))
    builder.getModulePassManager().run(module, builder)
    return machine.emit_assembly(module)
