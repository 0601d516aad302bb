"""What a user reads before a training begins: by which recipe, what it uses, and what it will take."""

from manyhands.training.recipe import Recipe, recipe_ids
from manyhands.training.settings import TrainSettings


def announce(recipe: Recipe | None, settings: TrainSettings) -> list[str]:
    """A few lines about the run."""
    if recipe is None:
        return [
            *_randomization(settings),
            f"No recipe is known for {settings.env_id}: the trainer's defaults may not solve it, and the run ends",
            f"after {settings.max_env_steps:,} steps. Recipes are shipped for {', '.join(recipe_ids())}.",
            "Try one of theirs with its environment changed (--recipe FILE), or single settings (--set; --help).",
        ]
    lines = [f"Recipe: {recipe.path}"]
    lines += [f"  {name}: {does}" for name, does in recipe.beyond.items()]
    if not recipe.beyond:
        lines.append("  nothing but the task's own reward")
    lines += _randomization(settings)
    if settings.workers is not None:
        lines.append(f"  with worlds on {settings.workers} workers, so what it will take is not known")
    elif not recipe.is_of(settings):
        lines.append("  with settings of yours, so what it will take is not known")
    elif recipe.measured is None:
        lines.append("  not measured: what it will take is not known")
    else:
        known = recipe.measured
        at_least = "at least " if known.success < 1 else ""
        seeds = f"the worst of {known.seeds} seeds" if known.seeds > 1 else "one seed"
        lines.append(
            f"Expect {at_least}{known.success:.1%} success after at most {_duration(known.seconds)} and "
            f"{known.env_steps:,} steps: {seeds} on {known.machine}"
        )
    return lines


def _randomization(settings: TrainSettings) -> list[str]:
    if not settings.randomize:
        return []
    ranges = ", ".join(f"{name} {low:g} to {high:g}" for name, low, high, _ in settings.ranges)
    config = settings.trainer_config()
    seen = config.privileged_critic and config.algorithm != "DAgger"  # which has no critics
    see = "critics see what was drawn, the policy does not" if seen else "neither critics nor policy see what was drawn"
    lines = [f"  randomised in every episode: {ranges}", f"  {see}; success below is under these ranges"]
    if config.algorithm == "TD3" and config.cloning_weight > 0 and config.cloning_filter:
        lines.append("  the script knows nothing of it: its answers count where critics expect more of them")
    return lines


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
