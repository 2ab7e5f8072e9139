# Completions of zsh after the tab key: a separate shell behind a terminal.
#   completes.zsh FOLDER_OF_COMPLETIONS 'BEGINNING OF A LINE'     prints the completed line
zmodload zsh/zpty
zpty shell zsh -f -i
{
  zpty -w shell "PS1= RPS1= PROMPT_SP=; unsetopt prompt_sp zle_bracketed_paste; fpath=($1 \$fpath)"
  zpty -w shell "autoload -Uz compinit && compinit -u -D; bindkey '^I' complete-word"
  # Ctrl-X shows what stands in the line once it is completed.
  zpty -w shell "show() { print -r -- \"<line>\$BUFFER</line>\"; }; zle -N show; bindkey '^X' show; print rea''dy"
  zpty -r shell seen '*ready*'
  zpty -w -n shell "$2"$'\t\C-x'
  zpty -r shell seen '*</line>*'
  print -r -- ${${seen##*<line>}%%</line>*}
} always {
  zpty -d shell
}
