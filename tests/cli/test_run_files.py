"""The files that a run reads and writes."""

from bikesim.record.reader import open_run

SHORT = ("--duration", 0.3, "--output", "run.h5")


class TestScenarioFile:
    def test_its_keys_count(self, cli, tmp_path):
        (tmp_path / "s.toml").write_text('bicycle = "davis"\nspeed = 5\nduration = 0.2\n')
        cli("run", "s.toml", "--output", "run.h5")
        run = open_run("run.h5")
        assert (run.bicycle.name, run.channel("speed")[0], run.ticks) == ("davis", 5, 200)

    def test_options_beside_it_replace_them(self, cli, tmp_path):
        (tmp_path / "s.toml").write_text('speed = 5\nduration = 0.2\nlaw = "off"\n')
        assert cli("run", "s.toml", "--speed", 4.2, "--output", "run.h5").status == 0
        run = open_run("run.h5")
        assert (run.channel("speed")[0], run.law) == (4.2, "off")

    def test_a_speed_beside_it_replaces_a_profile(self, cli, tmp_path):
        (tmp_path / "s.toml").write_text("speed_profile = [[0, 3], [1, 5]]\nduration = 0.2\n")
        cli("run", "s.toml", "--speed", 4.2, "--output", "run.h5")
        assert set(open_run("run.h5").channel("speed")) == {4.2}

    def test_set_changes_one_figure_of_a_table(self, cli, tmp_path):
        (tmp_path / "s.toml").write_text("duration = 0.2\n[rider]\narm_damping = 1.5\n")
        cli("run", "s.toml", "--set", "rider.arm_stiffness=4", "--output", "run.h5")
        scenario = open_run("run.h5").scenario
        assert "arm_damping = 1.5" in scenario
        assert "arm_stiffness = 4.0" in scenario

    def test_the_resolved_scenario_of_a_record_runs_again_bit_for_bit(self, cli, tmp_path):
        (tmp_path / "s.toml").write_text(
            'bicycle = "rigid"\nseed = 11\nlaw = "momentum"\nduration = 0.5\ngravity = 9.7\n'
            "speed_profile = [[0, 5], [0.4, 6]]\nperiod = 0.002\n"
            '[rider]\nname = "pd"\nremnant_rms = 0.05\n'
            '[rig]\nname = "delft2013"\nmotor_lag = 0.01\n'
            "[start]\nroll_deg = 1\n[[pushes]]\ntime = 0.1\nimpulse = 3\nheight = 1\n"
            "[guard]\ntorque_limit = 2\n"
        )
        assert cli("run", "s.toml", "--output", "first.h5").status == 0
        (tmp_path / "resolved.toml").write_text(cli("info", "first.h5", "--scenario").out)
        assert cli("run", "resolved.toml", "--output", "second.h5").status == 0
        assert open_run("first.h5").digest() == open_run("second.h5").digest()


class TestOutput:
    def test_folders_are_made(self, cli, tmp_path):
        assert cli("run", "--duration", 0.1, "--output", "a/b/c.h5").status == 0
        assert (tmp_path / "a/b/c.h5").is_file()

    def test_what_is_there_stays_without_force(self, cli, refusal, tmp_path):
        (tmp_path / "run.h5").write_text("precious")
        assert "run.h5: is already there; --force replaces it" in refusal("run", *SHORT)
        assert (tmp_path / "run.h5").read_text() == "precious"

    def test_force_replaces_it(self, cli, tmp_path):
        (tmp_path / "run.h5").write_text("old")
        assert cli("run", *SHORT, "--force").status == 0
        assert open_run("run.h5").complete

    def test_only_the_record_is_left(self, cli, tmp_path):
        cli("run", *SHORT)
        assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]

    def test_a_figure_beside_the_record(self, cli, tmp_path):
        said = cli("run", *SHORT, "--figure")
        assert "figure  run.png" in said.out
        assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")

    def test_a_figure_that_is_there_is_refused_before_the_run(self, refusal, tmp_path):
        (tmp_path / "run.png").write_text("old")
        assert "run.png: is already there" in refusal("run", *SHORT, "--figure")
        assert not (tmp_path / "run.h5").exists()

    def test_a_figure_never_takes_the_place_of_its_record(self, refusal, tmp_path):
        message = refusal("run", "--duration", 0.1, "--output", "run.png", "--figure")
        assert "run.png: would replace" in message
        assert list(tmp_path.iterdir()) == []

    def test_a_record_never_takes_the_place_of_its_scenario(self, refusal, tmp_path):
        (tmp_path / "s.toml").write_text("duration = 0.1\n")
        message = refusal("run", "s.toml", "--output", "s.toml", "--force")
        assert "s.toml: would replace" in message
