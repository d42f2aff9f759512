"""Films: closed forms, an independent program, and numpy's shapes."""

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, FileError, films

NM = np.arange(380, 781, 5)


def test_quarter_wave_layer_cancels_reflection():
    n = np.sqrt(1.5)
    assert films.reflectance([(n, 550 / (4 * n))], 550.0, substrate=1.5) < 1e-30


def test_bare_glass_equals_fresnel():
    theta = np.array([0.0, 30.0, 56.30993247402021, 80.0])
    inside = np.arcsin(np.sin(np.radians(theta)) / 1.5)
    c, t = np.cos(np.radians(theta)), np.cos(inside)
    s, p = ((c - 1.5 * t) / (c + 1.5 * t)) ** 2, ((1.5 * c - t) / (1.5 * c + t)) ** 2
    np.testing.assert_allclose(films.reflectance([], 550, theta, substrate=1.5, polarisation="s"), s, atol=1e-15)
    np.testing.assert_allclose(films.reflectance([], 550, theta, substrate=1.5, polarisation="p"), p, atol=1e-15)
    np.testing.assert_allclose(films.reflectance([], 550, theta, substrate=1.5), (s + p) / 2, atol=1e-15)


def test_arrays_broadcast_over_designs_wavelengths_and_angles():
    d, theta = np.linspace(0, 200, 7)[:, None, None], np.array([0.0, 20.0, 60.0])
    stack = [("Si3N4", 55.9), ("Cr:Johnson", 12.15), ("SiO2", d)]
    together = films.power(stack, NM[:, None], theta, incidence=1.5, substrate="Al")
    assert together.reflectance.shape == (7, 81, 3)
    for i, j, k in [(0, 0, 0), (3, 40, 2), (6, 80, 1)]:
        alone = films.power([*stack[:2], ("SiO2", d[i, 0, 0])], float(NM[j]), theta[k], incidence=1.5, substrate="Al")
        assert together.reflectance[i, j, k] == alone.reflectance
        assert together.transmittance[i, j, k] == alone.transmittance
    assert (together.absorptance > -1e-12).all()


def plain(layers, nm, theta, incidence, substrate, polarisation):
    """Reflectance and transmittance from characteristic matrices (Born and Wolf, section 1.6), one film at a time."""
    beta = incidence * np.sin(np.radians(theta))
    found = []
    for of in "sp" if polarisation == "mean" else polarisation:

        def admittance(n):
            q = np.sqrt(complex(n) ** 2 - beta**2)
            return q, q if of == "s" else q / complex(n) ** 2

        (_, eta_0), (_, eta) = admittance(incidence), admittance(substrate)
        matrix = np.eye(2, dtype=complex)
        for n, d in layers:
            q, y = admittance(n)
            delta = 2 * np.pi / nm * q * d
            matrix @= [[np.cos(delta), -1j * np.sin(delta) / y], [-1j * y * np.sin(delta), np.cos(delta)]]
        b, c = matrix @ [1, eta]
        found.append((abs((eta_0 * b - c) / (eta_0 * b + c)) ** 2, 4 * (eta_0 * eta.conjugate()).real / abs(eta_0 * b + c) ** 2))
    return np.mean(found, axis=0)


@pytest.mark.parametrize("polarisation", ["s", "p", "mean"])
def test_arrays_equal_single_films(polarisation):
    """Any quantity varies along any axis: each film equals the matrix method and a separate call."""
    random = np.random.default_rng(5)
    shape = (3, 5, 4)

    def drawn(axes, low, high):
        return random.uniform(low, high, [n if axis in axes else 1 for axis, n in enumerate(shape)])

    for axes in [(), (0,), (1,), (2,), (0, 1), (0, 2), (1, 2), (0, 1, 2)]:
        others = tuple({0, 1, 2} - set(axes))
        index = drawn(axes, 1.3, 2.5) + 1j * drawn(others, 0.0, 0.8)
        layers = [(index, drawn(others, 0, 200)), (1.46, drawn(axes, 0, 300)), (drawn(others, 1.4, 2.0), 80.0)]
        nm, theta, n0 = drawn(axes, 400, 700), drawn(others, 0, 80), drawn((1,), 1.0, 1.5)
        substrate = drawn((2,), 0.5, 1.4) + 1j * drawn(axes, 0.0, 6.0)
        together = films.power(layers, nm, theta, incidence=n0, substrate=substrate, polarisation=polarisation)
        everything = np.broadcast_arrays(nm, theta, n0, substrate, *(one for layer in layers for one in layer))
        assert together.reflectance.shape == everything[0].shape
        for at in np.ndindex(everything[0].shape):
            nm_0, theta_0, n0_0, substrate_0, *stack = (one[at] for one in everything)
            r, t = plain([*zip(stack[::2], stack[1::2], strict=True)], nm_0, theta_0, n0_0, substrate_0, polarisation)
            assert abs(together.reflectance[at] - r) < 1e-12 and abs(together.transmittance[at] - t) < 1e-12
        alone = films.reflectance(layers, nm, theta, incidence=n0, substrate=substrate, polarisation=polarisation)
        assert np.array_equal(alone, together.reflectance)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 1, 0, 2), (2, 3, 1, 0)])
@pytest.mark.parametrize("left_out", [None, 0, 1, 3])
def test_grid_equals_single_films(order, left_out):
    """Designs, angles, gaps and wavelengths on axes in any order, one of them possibly missing: the grid kernel, which reuses common
    factors, equals the point kernel, which also computes transmittance."""
    lengths = [1 if axis == left_out else n for axis, n in enumerate((3, 18, 20, 7))]

    def along(axis, values):
        shape = [lengths[axis] if one == axis else 1 for one in range(4)]
        return np.asarray(values)[: lengths[axis]].reshape(shape).transpose(order)

    designs, gaps = along(0, [30.0, 50.0, 70.0]), along(2, np.linspace(0, 500, 20))
    nm, theta = along(3, np.linspace(400, 700, 7)), along(1, np.linspace(0, 85, 18))
    stack = [("Si3N4", designs), (1.9 + designs / 100 + 0.3j, 12.0), ("air", gaps), ("Al", 20.0)]
    whole = films.reflectance(stack, nm, theta, incidence=1.2, substrate="SiO2", threads=1)
    points = films.power(stack, nm, theta, incidence=1.2, substrate="SiO2")
    assert whole.shape == points.reflectance.shape and whole.flags.c_contiguous
    np.testing.assert_allclose(whole, points.reflectance, rtol=0, atol=1e-12)
    assert films.reflectance(stack, nm, theta, incidence=1.2, substrate="SiO2", threads=3).tobytes() == whole.tobytes()


def test_transmittance_of_opaque_film_is_exact():
    """The transmittance is proportional to exp(-4 pi k d/lambda), even if it is very small."""
    d = np.array([200.0, 500.0, 1000.0, 2000.0])
    t = films.transmittance([(1 + 7j, d)], 550.0, substrate=1.5)
    np.testing.assert_allclose(np.diff(np.log(t)), -4 * np.pi * 7 / 550 * np.diff(d), rtol=1e-9)


def test_result_does_not_depend_on_threads():
    d = np.linspace(0, 300, 40_001)
    one, three = (films.power([("SiO2", d), ("Cr", 5.0)], 550.0, substrate="Al", threads=n) for n in (1, 3))
    assert one.reflectance.tobytes() == three.reflectance.tobytes() and one.transmittance.tobytes() == three.transmittance.tobytes()
    assert films.reflectance([("SiO2", np.zeros((0, 3)))], 550.0, substrate="Al").shape == (0, 3)


def test_indices_as_arrays_and_materials_agree():
    silica = films.index("SiO2", NM)
    assert abs(films.index("SiO2", 587.5618).real - 1.458464) < 1e-6  # Malitson 1965
    by_name = films.reflectance([("SiO2", 100.0)], NM, substrate="Al")
    assert (films.reflectance([(silica, 100.0)], NM, substrate="Al") == by_name).all()


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        ({"layers": [("SiO2", -1.0)]}, r"layers\[0\] thickness"),
        ({"layers": [("SiO2", "10 nm")]}, r"layers\[0\] thickness"),
        ({"layers": [("SiO2", np.nan)]}, r"layers\[0\] thickness"),
        ({"layers": [("Si02", 1.0)]}, r"layers\[0\]"),
        ({"layers": [("SiO2",)]}, r"layers\[0\]"),
        ({"layers": "SiO2"}, "layers"),
        ({"layers": 3}, "layers"),
        ({"layers": [(1.5 - 0.1j, 1.0)]}, "-0.1"),
        ({"layers": [(np.nan, 1.0)]}, r"layers\[0\]"),
        ({"layers": [(None, 1.0)]}, r"layers\[0\]"),
        ({"wavelength_nm": 0.0}, "wavelength_nm"),
        ({"wavelength_nm": "550"}, "wavelength_nm"),
        ({"wavelength_nm": 100.0}, r"layers\[0\]"),
        ({"theta_deg": 90.0}, "theta_deg"),
        ({"theta_deg": -1.0}, "theta_deg"),
        ({"theta_deg": np.zeros(4)}, "shapes do not broadcast"),
        ({"incidence": 0.0}, "incidence"),
        ({"substrate": "Unobtainium"}, "substrate"),
        ({"polarisation": "x"}, "polarisation"),
    ],
)
def test_invalid_arguments_are_named(arguments, names):
    good = {"layers": [("SiO2", 100.0)], "wavelength_nm": NM, "substrate": "Al"}
    with pytest.raises(ArgumentError, match=names):
        films.power(**{**good, **arguments})


def test_material_from_file_is_read(tmp_path, scenarios):
    path = tmp_path / "glass.csv"
    path.write_text("wavelength_nm,n,k\n300,1.5,0\n900,1.6,0\n")
    np.testing.assert_allclose(films.index(path, 600.0), 1.55)
    # A string is a name, or else a path, as in scenarios.
    np.testing.assert_allclose(films.index(str(path), 600.0), 1.55)
    assert films.reflectance([(str(path), 50.0)], 600.0, substrate=str(path)) == films.reflectance([(1.55, 50.0)], 600.0, substrate=1.55)
    with pytest.raises(FileError, match=r"absent\.yml"):
        films.index("absent.yml", 600.0)
    path.write_text("wavelength_nm,n,k\n300,x,0\n")
    with pytest.raises(FileError) as error:
        films.index(path, 600.0)
    assert error.value.line == 2
    with pytest.raises(FileError):
        films.index(tmp_path / "absent.csv", 600.0)


GAP_STACK = [("Si3N4", 55.9), ("Cr:Johnson", 12.15), ("SiO2", np.linspace(20, 60, 5)[:, None, None]), ("air", 190.0)]
LIGHT_NM, LIGHT_THETA = np.arange(400, 701, 20.0)[:, None], np.array([0.0, 30.0, 60.0])


@pytest.mark.parametrize("polarisation", ["s", "p", "mean"])
def test_layers_absorb_what_power_leaves(polarisation):
    layers = films.absorptance(GAP_STACK, LIGHT_NM, LIGHT_THETA, substrate="Al", polarisation=polarisation)
    assert layers.shape == (5, 16, 3, 4)
    np.testing.assert_allclose(layers.sum(axis=-1), films.power(GAP_STACK, LIGHT_NM, LIGHT_THETA, substrate="Al", polarisation=polarisation).absorptance, atol=1e-12)
    assert (layers[..., 3] == 0).all() or np.abs(layers[..., 3]).max() < 1e-12  # air


def test_amplitudes_give_the_powers():
    found, substrate = films.amplitudes(GAP_STACK, LIGHT_NM, LIGHT_THETA, substrate="Al"), films.index("Al", LIGHT_NM)
    cosine = np.cos(np.radians(LIGHT_THETA))
    root = np.sqrt(substrate**2 - np.sin(np.radians(LIGHT_THETA)) ** 2)
    for pol, r, t in (("s", found.r_s, found.t_s), ("p", found.r_p, found.t_p)):
        power = films.power(GAP_STACK, LIGHT_NM, LIGHT_THETA, substrate="Al", polarisation=pol)
        np.testing.assert_allclose(np.abs(r) ** 2, power.reflectance, atol=1e-12)
        # Poynting flux into an absorbing substrate (Macleod, section 2.9).
        flux = root.real if pol == "s" else (substrate * np.conj(root / substrate)).real
        np.testing.assert_allclose(np.abs(t) ** 2 * flux / cosine, power.transmittance, rtol=1e-9, atol=1e-14)


def test_ellipsometric_angles_equal_fresnel_formulas():
    """Bare silicon at 632.8 nm, and with oxide, by the textbook formulas in the convention n - ik (Azzam and Bashara)."""
    n_si, n_ox, nm, d = 3.87 - 0.0146j, 1.457, 632.8, 100.0
    sine = np.sin(np.radians(70.0))
    cos_air, cos_ox, cos_si = (np.sqrt(1 - (sine / n) ** 2 + 0j) for n in (1.0, n_ox, n_si))

    def fresnel(n_1, c_1, n_2, c_2):
        return (n_2 * c_1 - n_1 * c_2) / (n_2 * c_1 + n_1 * c_2), (n_1 * c_1 - n_2 * c_2) / (n_1 * c_1 + n_2 * c_2)

    top, bottom = fresnel(1.0, cos_air, n_ox, cos_ox), fresnel(n_ox, cos_ox, n_si, cos_si)
    turn = np.exp(-4j * np.pi * d / nm * n_ox * cos_ox)
    p, s = ((a + b * turn) / (1 + a * b * turn) for a, b in zip(top, bottom, strict=True))
    found = films.amplitudes([(n_ox, d)], nm, 70.0, substrate=np.conj(n_si))
    assert found.psi_deg == pytest.approx(np.degrees(np.arctan(abs(p / s))), abs=1e-9)
    assert found.delta_deg == pytest.approx(np.degrees(np.angle(p / s)) % 360, abs=1e-9)
    # A native oxide of 2 nm lowers Delta of silicon by about 6 degrees.
    bare, thin = (films.amplitudes(layers, nm, 70.0, substrate=np.conj(n_si)).delta_deg for layers in ([], [(n_ox, 2.0)]))
    assert 170 < thin < bare - 4 < 180


def test_derivatives_equal_differences():
    variables = [("thickness", 2), ("n", 0), ("k", 1), ("n", "substrate"), ("k", "substrate")]
    si, cr, al = films.index("Si3N4", LIGHT_NM), films.index("Cr:Johnson", LIGHT_NM), films.index("Al", LIGHT_NM)

    def stack(d=0.0, n=0.0, k=0.0):
        return [(si + n, 55.9), (cr + 1j * k, 12.15), ("SiO2", GAP_STACK[2][1] + d), ("air", 190.0)]

    found = films.derivatives(stack(), LIGHT_NM, LIGHT_THETA, substrate="Al", by=variables)
    assert found.derivatives.shape == (5, 16, 3, 5) and found.variables == variables
    np.testing.assert_allclose(found.reflectance, films.reflectance(stack(), LIGHT_NM, LIGHT_THETA, substrate="Al"), atol=1e-12)
    steps = [({"d": 1e-4}, 0, 0), ({"n": 1e-6}, 0, 0), ({"k": 1e-6}, 0, 0), ({}, 1e-6, 0), ({}, 0, 1e-6)]
    for at, (change, dn, dk) in enumerate(steps):
        step = max([*change.values(), dn, dk])
        above = films.reflectance(stack(**change), LIGHT_NM, LIGHT_THETA, substrate=al + dn + 1j * dk)
        below = films.reflectance(stack(**{name: -one for name, one in change.items()}), LIGHT_NM, LIGHT_THETA, substrate=al - dn - 1j * dk)
        np.testing.assert_allclose(found.derivatives[..., at], (above - below) / (2 * step), atol=1e-8)
    # Points in any arrangement: the thickness along the longest axis, and single points.
    thick = np.linspace(0, 100, 7)
    line = films.derivatives([("SiO2", thick)], 550.0, 20.0, substrate="Al")
    for i, d in enumerate(thick):
        assert line.derivatives[i, 0] == pytest.approx(films.derivatives([("SiO2", d)], 550.0, 20.0, substrate="Al").derivatives[0], abs=1e-12)
    # Without variables, and without layers, the reflectance is the same.
    for layers in (stack(), []):
        alone = films.derivatives(layers, LIGHT_NM, LIGHT_THETA, substrate="Al", by=[])
        assert alone.derivatives.shape == (*alone.reflectance.shape, 0)
        np.testing.assert_allclose(alone.reflectance, films.reflectance(layers, LIGHT_NM, LIGHT_THETA, substrate="Al"), atol=1e-12)
    assert np.array_equal(found.derivatives, films.derivatives(stack(), LIGHT_NM, LIGHT_THETA, substrate="Al", by=variables, threads=1).derivatives)


def test_medium_of_incidence_is_a_material():
    glass = films.index("SiO2", LIGHT_NM).real
    np.testing.assert_array_equal(
        films.reflectance(GAP_STACK, LIGHT_NM, LIGHT_THETA, substrate="Al", incidence="SiO2"), films.reflectance(GAP_STACK, LIGHT_NM, LIGHT_THETA, substrate="Al", incidence=glass)
    )


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: films.power([("SiO2", 1.0), (1.5 - 0.1j, 10.0)], 550.0, substrate="Al"), r"layers\[1\]: n = 1.5, k = -0.1; expected n and k of 0 or more"),
        (lambda: films.power([], 550.0, 90.0, substrate="Al"), "theta_deg: 90 is out of range; expected 0 to less than 90"),
        (lambda: films.power([], 550.0, substrate="Al", incidence="Al"), "incidence: k = .*; expected a transparent medium"),
        (lambda: films.derivatives([("SiO2", 1.0)], 550.0, substrate="Al", by=[("n", 1)]), r"by\[0\]: expected 0 to 0"),
        (lambda: films.derivatives([], 550.0, substrate="Al", by=[("thickness", "substrate")]), r"by\[0\]: the substrate has no thickness"),
        (lambda: films.derivatives([], 550.0, substrate="Al", by=["n"]), r"by\[0\]: expected a variable"),
    ],
)
def test_wrong_arguments_of_waves_are_named(call, says):
    with pytest.raises(papilio.ArgumentError, match=f"^{says}"):
        call()


def test_material_is_described_with_its_source():
    described = films.material_info("tio2")
    assert (described["name"], described["page"]) == ("TiO2", "main/TiO2/Siefke")
    at = described["wavelength_nm"] == 550.0
    np.testing.assert_allclose(films.index("TiO2", 550.0), described["n"][at][0] + 1j * described["k"][at][0])
    with pytest.raises(ArgumentError, match="did you mean `Al`"):
        films.index("Aluminium", 550.0)
    assert {"Nb2O5", "PMMA", "Mo"} <= set(films.material_names())
