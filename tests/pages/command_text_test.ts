// A suggested command, pasted into a shell, gives the words back.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { test } from "node:test";

import { command_text } from "../../src/pages/controls/command_text";

test("a POSIX shell reads the words as they were", () => {
  const words = ["a b.obj", "o'hara.obj", "'", "", "$HOME.obj", "`id`.obj", 'a"b', "a\\b", "*.obj", "~/a.obj", "#a", "a&b;c|d>e", "(a)", "!a", "a\nb\n", "\ta", "mütze.obj"];
  const { stdout } = spawnSync("sh", ["-c", command_text(["printf", "%s\\0", ...words])], { encoding: "utf8" });
  assert.deepEqual(stdout.split("\0").slice(0, -1), words);
});

test("words that a shell leaves alone stay without quotes", () => {
  assert.equal(command_text(["bespoke", "../my_models/a-1.obj", "--ease=1.5", "10%"]), "bespoke ../my_models/a-1.obj --ease=1.5 10%");
});
