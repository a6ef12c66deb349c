"""The network fitted by PyTorch: it finds what is there, runs alike without PyTorch, and says where that lacks."""

import numpy as np
import pytest
from click.testing import CliRunner
from stickslip.calibration.__main__ import calibration
from stickslip.calibration.network import MISSING, fit
from stickslip.calibration.scoring import auc
from stickslip.calibration.signals import Examples, examples
from stickslip.detect.judge.features.network import CHANNELS, LEAST, shipped_networks

RNG = np.random.default_rng(5)


def made(n: int) -> Examples:
    """Noise of three kinds of loop; "excited" has slips in its first channel, of a size that is told."""
    group = RNG.choice(["drift", "excited", "healthy"], n)
    x = [RNG.normal(size=(CHANNELS, points)).astype(np.float16) for points in RNG.integers(60, 130, n)]
    size = np.full((n, 2), np.nan, dtype=np.float32)
    for i in range(n):
        if group[i] == "excited":
            size[i] = RNG.uniform(-1.0, 0.0)
            x[i][0, :: RNG.integers(15, 25)] += 8.0 * np.exp(size[i, 0])
    return Examples(x, group, size)


def test_it_finds_what_is_there_and_runs_the_same_without_torch(monkeypatch):
    torch = pytest.importorskip("torch", reason="PyTorch (extra training) is not installed")
    models = []
    monkeypatch.setattr("stickslip.calibration.network.RISE", 500)
    own = fit.__globals__["untrained"]
    monkeypatch.setattr(
        "stickslip.calibration.network.untrained", lambda kinds: models.append(own(kinds)) or models[-1]
    )
    said = []
    net = fit(made(1600), said.append, passes=4)
    assert len(said) == 4 and float(said[-1].split()[-1]) < float(said[0].split()[-1])
    fresh = made(300)
    scores = np.array([net.scores(x.astype(np.float32)) for x in fresh.x])
    bad = fresh.group == "excited"
    assert auc(scores[:, net.names.index("sticky")], bad) > 0.9
    assert np.corrcoef(scores[bad, -2], fresh.size[bad, 0])[0, 1] > 0.5
    model = models[0].eval()
    with torch.no_grad():  # all records in one batch, the short ones filled up with zeros
        whole = np.stack([np.pad(x.astype(np.float32), ((0, 0), (0, 144 - x.shape[1]))) for x in fresh.x])
        z, size = model(torch.from_numpy(whole), torch.from_numpy(fresh.length))
    assert scores[:, :3] == pytest.approx(torch.log_softmax(z, 1).numpy().clip(LEAST), abs=1e-3)
    assert scores[:, -2:] == pytest.approx(size[:, :2].numpy(), abs=1e-3)


def test_signals_are_kept_and_equal_when_made_again(monkeypatch, tmp_path):
    monkeypatch.setattr("stickslip.calibration.signals.PART", 28)
    both = examples(tmp_path, 79, 2, kinds="moved")
    parts = sorted((tmp_path / "parts").iterdir())
    assert len(parts) == 2 and 50 <= len(both) <= 56 and len(both.x) == len(both)
    assert all(x.shape == (CHANNELS, points) for x, points in zip(both.x, both.length, strict=True))
    sticky = np.isin(both.group, ["cycling", "excited"])
    assert np.isfinite(both.size[sticky]).all() and np.isnan(both.size[~sticky]).all()
    parts[0].unlink()
    again = examples(tmp_path, 79, 2, kinds="moved")
    assert all(map(np.array_equal, both.x, again.x)) and np.array_equal(both.group, again.group)
    with pytest.raises(ValueError, match="holds another signals"):
        examples(tmp_path, 79, 2)


def test_without_torch_the_command_says_what_to_do(monkeypatch, tmp_path):
    monkeypatch.setattr("stickslip.calibration.commands.find_spec", lambda name: None)
    done = CliRunner().invoke(calibration, ["train", "--folder", str(tmp_path / "parts")])
    assert done.exit_code == 2 and MISSING in " ".join(done.output.split())
    assert not (tmp_path / "parts").exists()  # before anything is simulated


def test_a_network_that_goes_on_is_at_first_the_one_it_began_with():
    torch = pytest.importorskip("torch", reason="PyTorch (extra training) is not installed")
    from stickslip.calibration.network import go_on, taken, untrained

    (begun, *_) = shipped_networks()
    model = untrained(len(begun.kinds))
    go_on(model, begun)
    same = taken(model, begun.kinds)
    for name, w in begun.weights.items():
        assert same.weights[name] == pytest.approx(w, abs=1e-6), (
            name
        )  # analytic: normed by a mean of 0, a variance of 1
    x = torch.from_numpy(RNG.normal(size=(1, CHANNELS, 144)).astype(np.float32))
    model.fc.training = model.training = False  # drops nothing
    with torch.no_grad():
        z, _ = model(x, torch.tensor([144]))
    scores = begun.scores(x[0].numpy())[: len(begun.kinds)]
    assert scores == pytest.approx(torch.log_softmax(z, 1)[0].numpy().clip(LEAST), abs=1e-3)


def test_a_network_that_goes_on_refuses_kinds_that_it_does_not_know():
    pytest.importorskip("torch", reason="PyTorch (extra training) is not installed")
    with pytest.raises(ValueError, match="knows no new kind"):
        loops = made(20)
        fit(Examples(loops.x, np.full(20, "new kind"), loops.size), begun=shipped_networks()[0])
