# fish completion for bespoke: subcommands and options are those that its own help names.
function __bespoke_names
    set -l called bespoke
    set -l help (bespoke --help 2>/dev/null | string collect)
    for word in (commandline -opc)[2..-1]
        contains -- $word (__bespoke_subcommands $help); or break
        set -a called $word
        set help ($called --help 2>/dev/null | string collect)
    end
    __bespoke_subcommands $help
    string match -rg '^  (?:-[A-Za-z],)?(--[a-z-]+)' (string split \n -- $help)
end

function __bespoke_subcommands
    string match -rg '^  ([a-z]+)  ' (string split \n -- $argv[1])
end

complete -c bespoke -a '(__bespoke_names)'
