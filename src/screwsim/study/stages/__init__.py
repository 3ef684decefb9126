"""Two compressors in series: two scenes, what lies between them, and the pressure there (docs/model.md M200–M203)."""

from screwsim.study.stages.chain import StageChain
from screwsim.study.stages.explain import explain_stages
from screwsim.study.stages.read import read_stages, scene_or_stages
from screwsim.study.stages.result import ChainResult, solution_of
from screwsim.study.stages.schema import stages_schema
from screwsim.study.stages.solve import run_stages
