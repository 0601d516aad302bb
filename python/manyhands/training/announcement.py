"""What a user reads before a training begins: by which recipe, what it uses, and what it will take."""

from manyhands.training.recipe import Recipe, recipe_ids
from manyhands.training.settings import TrainSettings


def announce(recipe: Recipe | None, settings: TrainSettings) -> list[str]:
    """A few lines about the run."""
    if recipe is None:
        return [
            f"No recipe is known for {settings.env_id}: the trainer's defaults may not solve it, and the run ends",
            f"after {settings.max_env_steps:,} steps. Recipes are shipped for {', '.join(recipe_ids())}.",
            "Try one of theirs with its environment changed (--recipe FILE), or single settings (--set; --help).",
        ]
    lines = [f"Recipe: {recipe.path}"]
    lines += [f"  {name}: {does}" for name, does in recipe.beyond.items()]
    if not recipe.beyond:
        lines.append("  nothing but the task's own reward")
    changed = settings.num_envs != recipe.num_envs or settings.overrides != recipe.trainer
    if settings.workers is not None:
        lines.append(f"  with worlds on {settings.workers} workers, so what it will take is not known")
    elif changed:
        lines.append("  with settings of yours, so what it will take is not known")
    elif recipe.measured is None:
        lines.append("  not measured: what it will take is not known")
    else:
        known = recipe.measured
        lines.append(
            f"Expect {known.success:.1%} success or more after at most {_duration(known.seconds)} and "
            f"{known.env_steps:,} steps: the worst of {known.seeds} seeds on {known.machine}"
        )
    return lines


def _duration(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
