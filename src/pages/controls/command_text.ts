const plain = /^[\w./%=:,+-]+$/;

/** A command to be pasted into a POSIX shell, quoted as `command_text` of tools/bespoke/page_output.cpp does. */
export function command_text(words: string[]): string {
  return words.map((word) => (plain.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`)).join(" ");
}
