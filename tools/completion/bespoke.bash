# bash completion for bespoke: subcommands and options are those that its own help names.
_bespoke() {
  local word=${COMP_WORDS[COMP_CWORD]} help names i
  local -a called=("${COMP_WORDS[0]}")
  help=$("${called[@]}" --help 2>/dev/null)
  for ((i = 1; i < COMP_CWORD; i++)); do
    names=$(sed -n 's/^  \([a-z][a-z]*\)  .*/\1/p' <<<"$help")
    grep -qx -- "${COMP_WORDS[i]}" <<<"$names" || break
    called+=("${COMP_WORDS[i]}")
    help=$("${called[@]}" --help 2>/dev/null)
  done
  if [[ $word == -* ]]; then
    names=$(grep -oE '^  (-[A-Za-z],)?--[a-z-]+' <<<"$help" | grep -oE -- '--[a-z-]+')
  elif [ "$i" -eq "$COMP_CWORD" ]; then
    names=$(sed -n 's/^  \([a-z][a-z]*\)  .*/\1/p' <<<"$help")
  else
    names=
  fi
  mapfile -t COMPREPLY < <(compgen -W "$names" -- "$word")
}
complete -o default -F _bespoke bespoke
