"""Tables of `./tools/benchmark signal` beyond its figures."""

from typing import Any

from quiesce_benchmarks.house.markdown import count, markdown, number

LEAST_SHOWN_INSTR = 20.0


def accuracy_table(signal: dict[str, Any]) -> str:
    """Against the Cramer-Rao bound, frequencies at random over the band."""
    rows = [
        [
            f"{one['snr_dB']:g} dB",
            number(one["rmse_over_bound"], 2),
            f"{one['rmse_Hz']:.2g}",
            f"{one['phase_rms_deg']:.2g} ({one['phase_bound_deg']:.2g})",
        ]
        for one in signal["context"]["accuracy"]
        if one["group"] == "band"
    ]
    head = ["SNR a sample", "frequency error, of the bound", "frequency error, Hz"]
    return markdown([*head, "phase error, degree (bound)"], rows)


def step_table(signal: dict[str, Any]) -> str:
    """Steps of the frozen plant's drive, beside least squares over windows of equal length."""
    rows = [
        [
            f"{step['step']}, {step['current_A']:g} A",
            f"{step['settle_s']:g} s",
            f"{step['offline_settle_s']:g} s",
            f"{step['invalid_after_ms']:g} ms",
        ]
        for step in signal["context"]["plant_steps"]
    ]
    return markdown(["step, current", "settles in", "least squares", "invalid after"], rows)


def cost_table(signal: dict[str, Any]) -> str:
    """Instructions of a signal tick by tick rate."""
    keys = ("worst_instr", "median_instr", "mean_instr", "ram_bytes", "stack_bytes")
    rows = [
        [f"{rate['tick_rate_Hz']} Hz", *(count(rate[key]) for key in keys)]
        for rate in signal["context"]["cost"]["ticks"]
    ]
    head = ["tick rate", "worst tick", "median", "mean", "RAM, bytes", "stack, bytes"]
    return markdown(head, rows)


def module_table(signal: dict[str, Any]) -> str:
    """Where the mean tick at the default rate goes, source file by source file."""
    modules = signal["context"]["cost"]["modules_mean_instr"]
    shown = {name: mean for name, mean in modules.items() if mean >= LEAST_SHOWN_INSTR}
    rest = sum(modules.values()) - sum(shown.values())
    return markdown([*shown, "the rest"], [[count(mean) for mean in (*shown.values(), rest)]])


def peer_table(signal: dict[str, Any]) -> str:
    cost = signal["context"]["cost"]
    worst = next(one["worst_instr"] for one in cost["ticks"] if one["tick_rate_Hz"] == 1000)
    keys = ("fft_instr", "magnitude_instr", "rms_instr", "peak_instr")
    rows = [
        [
            peer["number_format"],
            *(count(peer[key]) for key in keys),
            number(peer["peak_instr"] / worst),
            count(peer["mean_instr"]),
        ]
        for peer in cost["peers"]
    ]
    head = ["peer", "FFT", "magnitudes", "RMS", "peak tick", "over our worst tick"]
    return markdown([*head, "mean a tick at 20 a second"], rows)
