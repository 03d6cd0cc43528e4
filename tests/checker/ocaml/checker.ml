(* A second checker of navsym's certificates, written from docs/certificates.md alone.

   checker FILE   one certificate; exit code 0 accepted, 1 refused, 2 outside
   checker        lines `id TAB certificate` from standard input; a line `id TAB answer` for each

   The answers are `accepted`, `refused: why` and `outside: what`. What the page does not specify, or what is not implemented here, is
   outside; it is never accepted. *)

open Text
open Tree
open Ball
open Value
open Goal
open Rules

(* Statements. Of section 9 only hypotheses between plain expressions are read; all else of it is outside. *)

type statement = {
  goals : (tree * relation) list;
  box : (string * range) list;
  said : tree list; (* what has to have a value *)
  given : tree list;
  zeros : tree list;
}

let words_of_section_9 =
  [ "where"; "min"; "max"; "sign"; "transpose"; "cross"; "dot"; "norm"; "skew"; "det"; "inv"; "trace"; "eye"; "zeros"; "diag" ]
  @ [ "qmul"; "conj"; "rot"; "diff"; "dot_"; "integral"; "sum"; "product"; "limit" ]

(* A plain expression, or a text of section 9 *)
let read_side text =
  if String.exists (fun c -> String.contains "@[]<>=!" c) text then outside "matrices, or conditions inside an expression";
  try read_tree text
  with Refused why ->
    let is_called word = why = "expression: unknown function " ^ word in
    if List.exists is_called words_of_section_9 then outside "a function of section 9" else raise (Refused why)

let get_side what = function Text s -> read_side s | _ -> refuse "%s: expected an expression" what

let read_goals left right relation tolerance =
  let d = subtract left right in
  match (relation, tolerance) with
  | "=", None -> [ (d, Equal) ]
  | "=", Some e -> [ (Sum [ e; d ], AtLeast); (Sum [ e; negate d ], AtLeast) ]
  | _, Some _ -> refuse "a tolerance goes with = only"
  | "!=", None -> [ (d, Unequal) ]
  | ">", None -> [ (d, Above) ]
  | ">=", None -> [ (d, AtLeast) ]
  | "<", None -> [ (subtract right left, Above) ]
  | "<=", None -> [ (subtract right left, AtLeast) ]
  | _ -> refuse "unknown relation %S" relation

(* The two sides of a condition and its relation, which is the first of the marks that stands in the text *)
let split_condition text =
  let n = String.length text in
  let starts i mark = i + String.length mark <= n && String.sub text i (String.length mark) = mark in
  let rec go i =
    if i >= n then refuse "given: expected a relation"
    else
      match List.find_opt (starts i) [ "!="; ">="; "<="; "="; ">"; "<" ] with
      | Some mark ->
          let after = i + String.length mark in
          (read_side (String.sub text 0 i), mark, read_side (String.sub text after (n - after)))
      | None -> go (i + 1)
  in
  go 0

(* Supposes a condition. *)
let suppose s value =
  let x, mark, y = split_condition (get_text "given" value) in
  let distance a b = match (a, b) with a, Num q when Q.sign q = 0 -> a | Num q, b when Q.sign q = 0 -> negate b | _ -> subtract a b in
  let with_value s t = { s with said = s.said @ [ t ] } in
  let away s d = with_value s (Pow (d, Num Q.minus_one)) in
  let at_least s d = { (with_value s d) with given = s.given @ [ d ] } in
  match mark with
  | "=" -> let d = distance x y in { (with_value s d) with zeros = s.zeros @ [ d ] }
  | "!=" -> let d = distance x y in away (with_value s d) d
  | ">" -> let d = distance x y in away (at_least s d) d
  | "<" -> let d = distance y x in away (at_least s d) d
  | ">=" -> at_least s (distance x y)
  | _ -> at_least s (distance y x)

let plain_keys = [ "left"; "right"; "relation"; "symbols"; "exists"; "tolerance" ]

let read_hypotheses o =
  if List.mem_assoc "order" o then outside "statement with order";
  let more = [ "shapes"; "given"; "rates" ] in
  if not (List.exists (fun k -> List.mem_assoc k o) more) then []
  else
    match get_keys "statement" (plain_keys @ more) (Object o) with
    | [ _; _; _; _; _; _; shapes; given; rates ] ->
        if shapes <> Object [] || rates <> Object [] then outside "shapes and rates";
        get_list "given" given
    | _ -> assert false

let read_statement value =
  let o = get_object "statement" value in
  let hypotheses = read_hypotheses o in
  let plain = Object (List.filter (fun (k, _) -> not (List.mem k [ "shapes"; "given"; "rates" ])) o) in
  match get_keys "statement" plain_keys plain with
  | [ left; right; relation; symbols; exists; tolerance ] ->
      let left = get_side "left" left and right = get_side "right" right in
      let tolerance = match tolerance with Null -> None | v -> Some (get_tree "tolerance" v) in
      let exists = List.map (get_side "exists") (get_list "exists" exists) in
      let read (name, v) = if is_name name then (name, read_range name v) else refuse "expected a name" in
      let box = List.map read (get_object "symbols" symbols) in
      let said = (left :: right :: Option.to_list tolerance) @ exists in
      let goals = read_goals left right (get_text "relation" relation) tolerance in
      List.fold_left suppose { goals; box; said; given = []; zeros = [] } hypotheses
  | _ -> assert false

(* A tree of `given` that is a symbol, or -1 times a symbol, cuts the range at 0. *)
let goal_of s (tree, relation) =
  let goal = { tree; relation; box = s.box; exists = s.said; given = s.given; zeros = s.zeros } in
  let cut goal = function
    | Sym name -> cut_range goal name 1
    | Prod [ Num q; Sym name ] when Q.equal q Q.minus_one -> cut_range goal name (-1)
    | _ -> goal
  in
  List.iter (fun t -> check_symbols (premise goal t relation)) (s.said @ s.given @ s.zeros);
  List.fold_left cut goal s.given

(* All that the statement says has a finite ball at a point in the box, and the hypotheses hold there. *)
let check_values s point =
  check_point s.box point;
  let balls = List.map (fun (name, t) -> (name, number_ball name t)) point in
  let value name = match List.assoc_opt name balls with Some x -> x | None -> no_symbols name in
  List.iter (fun t -> if finite_ball value t = None then refuse "no value at the point") s.said;
  let is_positive t = match finite_ball value t with Some x -> sign_of x.lo >= 0 | None -> false in
  let is_null t = Algebra.vanishes (put point t) in
  shown "a hypothesis does not hold at the point"
    (List.for_all (fun t -> is_positive t || is_null t) s.given && List.for_all is_null s.zeros);
  value

(* Kinds *)

let keep_out_answers value = if List.mem_assoc "answers" (get_object "certificate" value) then outside "answers"

let check_identity value =
  match get_keys "identity" [ "kind"; "left"; "right"; "symbols" ] value with
  | [ _; left; right; symbols ] ->
      let names = List.map (get_name "symbols") (get_list "symbols" symbols) in
      if List.length (List.sort_uniq compare names) <> List.length names then refuse "a name given twice";
      let difference = subtract (get_tree "left" left) (get_tree "right" right) in
      Names.iter (fun s -> if not (List.mem s names) then no_symbols s) (Tree.symbols difference);
      shown "the sides differ" (Algebra.normal_form_vanishes difference)
  | _ -> assert false

let check_positivity value =
  match get_keys "positivity" [ "kind"; "expression"; "box"; "bits"; "cells" ] value with
  | [ _; expression; box; bits; cells ] ->
      let t = get_tree "expression" expression and bits = get_bits 20000 bits in
      let cells = get_integer "cells" 0 (most_cells bits) cells in
      at_precision bits (fun () ->
          let read (name, v) =
            match get_list name v with
            | [ low; high ] when is_name name ->
                let low = number_ball name (get_tree name low) in
                (name, { low; length = less (number_ball name (get_tree name high)) low; start = Z.zero; level = 0 })
            | _ -> refuse "box: expected [from, to] by name"
          in
          let sides = List.map read (get_object "box" box) in
          Names.iter (fun s -> if not (List.mem_assoc s sides) then no_symbols s) (Tree.symbols t);
          let settled cell =
            let balls = Map_of_names.map part_ball cell in
            match ball Whole (find balls) t with x -> is_above x | exception No_value -> false
          in
          let box = List.fold_left (fun m (n, s) -> Map_of_names.add n s m) Map_of_names.empty sides in
          bisect ~cells:(cells_allowed cells) ~names:(List.map fst sides) ~settled box)
  | _ -> assert false

let check_proof value =
  keep_out_answers value;
  match get_keys "proof" [ "kind"; "statement"; "bits"; "witness"; "proofs" ] value with
  | [ _; statement; bits; witness; proofs ] ->
      at_precision (get_bits 20000 bits) (fun () ->
          let s = read_statement statement in
          let (_ : string -> ball) = check_values s (read_numbers "witness" witness) in
          prove_each "proofs" (List.map (goal_of s) s.goals) (get_list "proofs" proofs))
  | _ -> assert false

let fails value (t, relation) =
  match finite_ball value t with
  | None -> false
  | Some x -> (
      match relation with
      | Equal -> not (has_zero x)
      | Unequal -> is_exactly_zero x
      | Above -> sign_of x.hi <= 0
      | AtLeast -> is_below x)

let check_counterexample value =
  keep_out_answers value;
  match get_keys "counterexample" [ "kind"; "statement"; "bits"; "point"; "zero" ] value with
  | [ _; statement; bits; point; zero ] ->
      at_precision (get_bits 200000 bits) (fun () ->
          let s = read_statement statement in
          let point = read_numbers "point" point in
          let value = check_values s point in
          match (zero, s.goals) with
          | Null, goals -> shown "the statement is not seen to fail" (List.exists (fails value) goals)
          | proof, [ (t, (Above | Unequal)) ] -> prove (alone (put point t) Equal) proof
          | _ -> refuse "the relation allows 0")
  | _ -> assert false

let rec check value =
  match List.assoc_opt "kind" (get_object "certificate" value) with
  | None -> refuse "expected the key kind"
  | Some kind -> (
      match get_text "kind" kind with
      | "identity" -> check_identity value
      | "positivity" -> check_positivity value
      | "proof" -> check_proof value
      | "counterexample" -> check_counterexample value
      | "all" -> (
          match get_keys "all" [ "kind"; "of" ] value with
          | [ _; List (_ :: _ as l) ] -> List.iter check l
          | _ -> refuse "of: expected a list of at least one certificate")
      | name -> outside "kind %s" name)

(* Answers *)

type answer = Accepted | Refusal of string | Not_here of string

let judge text =
  Algebra.forget ();
  precision := 96;
  match check (read_document text) with
  | () -> Accepted
  | exception Refused why -> Refusal why
  | exception Outside what -> Not_here what
  | exception Stack_overflow -> Refusal "too deep"
  | exception Out_of_memory -> Refusal "too large"
  | exception No_value -> Refusal "no value"
  | exception Nowhere -> Refusal "no value"
  | exception Z.Overflow -> Refusal "a number too large"
  | exception Division_by_zero -> Refusal "a division by 0"

let printed = function Accepted -> "accepted" | Refusal why -> "refused: " ^ why | Not_here what -> "outside: " ^ what

let judge_lines () =
  try
    while true do
      let line = input_line stdin in
      match String.index_opt line '\t' with
      | None -> Printf.printf "?\trefused: expected an id, a tab and a certificate\n%!"
      | Some i ->
          let text = String.sub line (i + 1) (String.length line - i - 1) in
          Printf.printf "%s\t%s\n%!" (String.sub line 0 i) (printed (judge text))
    done
  with End_of_file -> ()

let judge_file path =
  let channel = open_in_bin path in
  let answer = judge (really_input_string channel (in_channel_length channel)) in
  print_endline (printed answer);
  exit (match answer with Accepted -> 0 | Refusal _ -> 1 | Not_here _ -> 2)

let () =
  match Array.to_list Sys.argv with
  | [ _ ] -> judge_lines ()
  | [ _; path ] -> ( try judge_file path with Sys_error why -> prerr_endline why; exit 3)
  | _ -> prerr_endline "usage: checker [FILE]"; exit 3
