# Completion of `slom` in bash: subcommands, options, and what an option may be, as the command's own help lists them; else files.
_slom() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} words=() choices=() i
  # Readline takes the = of --option=value for a word.
  if [[ $word == "=" ]]; then
    word=
  elif [[ $before == "=" && COMP_CWORD -gt 1 ]]; then
    before=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${COMP_WORDS[i]} =~ ^[a-z]+[a-z-]*$ ]] || break
    words+=("${COMP_WORDS[i]}")
  done
  local help
  help=$("${COMP_WORDS[0]}" "${words[@]}" --help 2>/dev/null) ||
    help=$("${COMP_WORDS[0]}" "${words[@]:0:1}" --help 2>/dev/null) || return
  # Less usual options are in --help-all.
  if [[ $help == *$'\n'"  --help-all "* ]]; then
    help=$("${COMP_WORDS[0]}" "${words[@]}" --help-all 2>/dev/null) ||
      help=$("${COMP_WORDS[0]}" "${words[@]:0:1}" --help-all 2>/dev/null) || return
  fi
  local listed='^  (-h,)?(--?[a-z][a-z-]*)(.*)$' subcommand='^  ([a-z][a-z-]*)( |$)' in_subcommands= line
  while IFS= read -r line; do
    if [[ $line == "Subcommands:" ]]; then
      in_subcommands=1
    elif [[ -n $in_subcommands && $line =~ $subcommand ]]; then
      [[ $word != -* ]] && choices+=("${BASH_REMATCH[1]}")
    elif [[ $line =~ $listed ]]; then
      local option=${BASH_REMATCH[2]} value=${BASH_REMATCH[3]}
      if [[ $option == "$before" && $value =~ ^\ ([a-z-]+(\|[a-z-]+)+) ]]; then
        IFS='|' read -ra choices <<<"${BASH_REMATCH[1]}"
        break
      fi
      [[ $word == -* ]] && choices+=("$option")
    fi
  done <<<"$help"
  if ((${#choices[@]} > 0)); then
    mapfile -t COMPREPLY < <(compgen -W "${choices[*]}" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}
complete -o filenames -o bashdefault -F _slom slom
