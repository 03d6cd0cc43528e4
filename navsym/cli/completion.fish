# completion of navsym for fish
complete -c navsym -a '(navsym completion words (commandline -cp) 2>/dev/null)'
